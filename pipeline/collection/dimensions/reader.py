"""Tokens -> groups of numbers with the part that each belongs to.  One pass, with a short look ahead."""

from __future__ import annotations

from pipeline.collection.dimensions.pairing import agree, is_in_inches, pair
from pipeline.collection.dimensions.parts import is_base, is_detail, is_opening
from pipeline.collection.dimensions.phrases import Phrase, phrase_of
from pipeline.collection.dimensions.quantities import DimensionQuantity, Group
from pipeline.collection.dimensions.result import DimensionNote
from pipeline.collection.dimensions.runs import area_at, conversion_at, run_at
from pipeline.collection.dimensions.tokens import (
    BREAK,
    CLOSE,
    COLON,
    COMMA,
    DASH,
    DIMENSION,
    DOT,
    DOTTED,
    END,
    JOIN,
    NUMBER,
    OPEN,
    TIME,
    UNIT,
    WORD,
    Token,
)

_LONGEST_REMARK = 20  # tokens; so that no text makes the reader look at its words again and again
_BEHIND = ("with", "framed", "unframed")
_STATES = frozenset({"folded", "unfolded", "open", "opened", "closed", "unopened", "assembled", "extended"})
_VOLUMES = frozenset({"volum", "vol", "volume", "volumen", "volumul"})
_STRAY = frozenset("'\"’”′″")
_ASIDE = frozenset({OPEN, CLOSE, COLON, COMMA, DASH, DOT})


def _is_whole(group: Group) -> bool:
    """Say whether a group gives the object itself a size by its label."""
    return group.name == "overall" and any(q.dimension for q in group.quantities)


class Reader:
    """Reads one text; `groups` and `notes` hold what it said."""

    def __init__(self, text: str, tokens: list[Token], default_unit: bool) -> None:
        self.text = text
        self.tokens = tokens
        self.default_unit = default_unit
        self.groups: list[Group] = []
        self.notes: list[DimensionNote] = []
        self.label: list[int] = []  # words since the last number: the next number's label, or the last one's remark
        self.open: list[DimensionQuantity] = []  # numbers of this clause that have no conversion yet
        self.fresh = True  # no number since the last line break
        self.runs = 0
        self.current: Group | None = None  # the one that the last numbers went to

    def read(self) -> None:
        """Read the whole text."""
        tokens = self.tokens
        at = 0
        while True:
            token = tokens[at]
            kind = token.type
            if kind == END:
                self._remark()
                return
            if kind in (NUMBER, DOTTED, DIMENSION):
                legend = kind == DIMENSION and bool(self.label) and tokens[self.label[-1]].type == JOIN
                behind = 0 if legend else self._measure(at)
                if behind:
                    at = behind
                    continue
                self.label.append(at)
            elif kind == TIME:
                unit = tokens[at + 1].unit if tokens[at + 1].type == UNIT else None
                if unit is not None and unit.kind == "length":  # 30:40 cm
                    self.label.append(at)
                else:
                    at = self._leave_out(at, at + 1, "a time, a date or a scale")
                    continue
            elif kind == BREAK:
                self._break(at)
            elif kind == COMMA:
                if not self.fresh and self.label and (self._is_remark() or self._trails(at)):
                    self._remark()
                else:
                    self.label.append(at)
            elif kind == OPEN and not self.label and not self.fresh:
                at = self._brackets(at)
                continue
            elif kind == OPEN and self.current and self._repeats(at):
                self._remark()
                at = self._conversions(at, self.current)
                continue
            else:
                self.label.append(at)
                if kind == DOT and self._is_sentence():
                    self._remark()
            at += 1

    def _measure(self, at: int) -> int:
        """Read the numbers that begin at a token into a group; return the token behind them, 0 where none begin."""
        tokens = self.tokens
        behind = area_at(tokens, at)
        if behind:
            return self._leave_out(at, behind, "an area or a volume")
        found = run_at(tokens, at, self.text)
        if found is None:
            return 0
        items, behind = found
        if any(q.kind not in ("", "length", "mass") for q in items):
            return self._leave_out(at, behind, "neither a length nor a mass")
        if not self._measures(at, items, behind):
            return 0
        if items[0].unit is None and len(items) == 1 and self._is_volume(items[0].word):
            return self._leave_out(at, behind, "an area or a volume")
        if items[-1].unit is None and (tokens[behind].type == DASH or tokens[behind].word == "to"):
            other = run_at(tokens, behind + 1, self.text)  # 24 x 18 - 25 x 19 in.
            if other is not None and other[0][0].kind == "length":
                for item in items:
                    item.unit = other[0][0].unit
        phrase = phrase_of(tokens, self.label, self.text)
        if self.label and tokens[self.label[-1]].start == tokens[at].start:
            phrase.dimensions.append(items[0].dimension)  # one word for both, such as 底径
        inner = (tokens[i].meaning for i in range(at, behind))
        phrase.qualifiers |= {meaning[1] for meaning in inner if meaning and meaning[0] == "qualifier"}
        group = self._group(phrase, items)
        for item in items:
            item.run = self.runs
            if not item.dimension and item.kind == "mass":
                item.dimension = "weight"
        self._apply(phrase, items)
        self.runs += 1
        group.quantities += items
        self.open += items
        self.label = []
        self.fresh = False
        return self._conversions(behind, group)

    def _is_volume(self, number: str) -> bool:
        """Whether a decimal number stands behind "Vol.", as cubic metres do; "Volume 2" is a part."""
        words = [self.tokens[at].word for at in self.label if self.tokens[at].type == WORD]
        return bool(words) and words[-1] in _VOLUMES and not number.isdigit()

    def _measures(self, at: int, items: list[DimensionQuantity], behind: int) -> bool:
        """Say whether numbers measure something; a number without unit and partner may as well count or name a part."""
        tokens = self.tokens
        first = tokens[at]
        if len(items) > 1:
            # "d: 4 x 6": the letter numbers a component.
            letter = first.type == DIMENSION and first.end - first.start == 1
            return not (letter and tokens[at + 1].type == COLON and not any(q.dimension for q in items[1:]))
        item = items[0]
        if item.unit is not None:
            return True
        if first.type == DOTTED or self.text[first.end : first.end + 1].isalpha():
            return False  # ".1b": the number of a component
        if item.dimension or self._is_labelled():
            return tokens[behind].type != COLON
        if tokens[behind].type == OPEN:  # 11 (27.9 cm)
            other = conversion_at(tokens, behind, self.text)
            return other is not None and len(other[0]) == 1 and is_in_inches(item, other[0][0])
        if tokens[behind].type not in (END, BREAK, COMMA, CLOSE, DOT):
            return False
        alone = not self.label or tokens[self.label[-1]].type == COLON
        return alone and (self.default_unit or (at == 0 and tokens[behind].type == END))

    def _is_labelled(self) -> bool:
        """Whether the words before a number are a label and what is known of parts: "H. avec couvercle 28"."""
        if len(self.label) > _LONGEST_REMARK:
            return False
        phrase = phrase_of(self.tokens, self.label, self.text)
        return bool(phrase.dimensions and phrase.name and phrase.known) and not phrase.joined

    def _conversions(self, at: int, group: Group) -> int:
        """Pair the numbers with the same in another system, in brackets or behind a stroke; return the token behind."""
        tokens = self.tokens
        while True:
            place = at + 1 if tokens[at].type == DOT else at
            if tokens[place].type == OPEN:
                found = conversion_at(tokens, place, self.text)
                if found is None:
                    return at
                others, at = found
                left = pair(self.open, others, self.notes)
                for q in left:
                    if q.kind == "mass":
                        q.dimension, q.run = "weight", self.runs
                    elif q.run < 0:
                        q.run = self.runs
                self.runs += 1
                group.quantities += left
                self.open = []
            elif tokens[place].type in (COMMA, COLON, DASH, NUMBER) or tokens[place].word in (
                "/",
                "|",
                ";",
                "or",
                "\\",
            ):
                start = place if tokens[place].type == NUMBER else place + 1
                behind = self._same(start)
                if not behind:
                    return at
                at = behind
            elif tokens[place - 1].type == CLOSE and self._labels(named := place + (tokens[place].word == "in"), group):
                at = named + 1
            elif tokens[place].type == JOIN:
                behind = self._joined(place + 1, group)
                if not behind:
                    return at
                at = behind
            else:
                return at

    def _labels(self, at: int, group: Group) -> bool:
        """Give a number the label behind its conversion, as in '28 7/8 in. (73.3 cm) height x 10 in. (25 cm) diam.'."""
        if self.tokens[at].type != DIMENSION:
            return False
        behind = at + 2 if self.tokens[at + 1].type == DOT else at + 1
        last, meaning = group.quantities[-1], self.tokens[at].meaning
        mates = [q for q in group.quantities if q.run == last.run and q is not last]
        ends = self.tokens[behind].type in (JOIN, END, BREAK, COMMA)
        if not ends or last.dimension or meaning is None or not all(q.dimension for q in mates):
            return False
        last.dimension = meaning[1]
        return True

    def _same(self, at: int) -> int:
        """Take a run that repeats the open numbers in the other system and agrees with all; else return 0."""
        if self.tokens[at].type != NUMBER:
            return 0
        found = run_at(self.tokens, at, self.text)
        if found is None or not self._are_open(found[0]):
            return 0
        pair(self.open, found[0], self.notes)
        self.open = []
        return found[1]

    def _are_open(self, items: list[DimensionQuantity]) -> bool:
        """Whether numbers without labels are the open ones in the other system, each in agreement."""
        if not items or len(items) != len(self.open):
            return False
        for a, b in zip(self.open, items, strict=True):
            if a.unit is None or b.unit is None or a.unit.kind != b.unit.kind or a.unit.system == b.unit.system:
                return False
            if a.kind not in ("length", "mass") or not agree(a.si(), b.si(), a.kind) or b.dimension:
                return False
        return True

    def _repeats(self, at: int) -> bool:
        """Whether brackets behind a label repeat the numbers before it, which it then names: 11 in., diam. (28 cm)."""
        if len(self.label) > _LONGEST_REMARK or any(self.tokens[i].type == NUMBER for i in self.label):
            return False
        found = conversion_at(self.tokens, at, self.text)
        return found is not None and self._are_open(found[0])

    def _joined(self, at: int, group: Group) -> int:
        """Read on in '6 in. (15 cm) x 8 in. (20 cm)': the next number goes on with that run; 0 where none does."""
        found = run_at(self.tokens, at, self.text)
        if found is None or any(q.kind not in ("", "length") for q in found[0]):
            return 0
        items, behind = found
        run = group.quantities[-1].run
        for item in items:
            item.run = run
        group.quantities += items
        self.open += items
        return behind

    def _group(self, phrase: Phrase, items: list[DimensionQuantity]) -> Group:
        """Return the group that numbers belong to: the last one where they go on with it, else a new one."""
        last = self._target(phrase, items)
        if last is not None and not self.fresh:
            named = last.named() if "height" in last.named() else {q.dimension for q in last.quantities if q.dimension}
            spoken = [q.dimension or "".join(phrase.dimensions[-1:] if len(items) == 1 else "") for q in items]
            continues = all(one and one not in named for one in spoken)
            weighs = items[0].kind == "mass" and bool(items[0].dimension or phrase.dimensions)
            aside = len(items) == 1 and not weighs and any(self.tokens[at].type == COMMA for at in self.label)
            if items[0].kind == "mass" and (items[0].dimension or phrase.dimensions):
                continues = last.name == "overall"  # "Weight: 20 kg" behind the base is the whole object's
            elif items[0].kind == "mass":
                continues = True
            if continues or (not phrase.name and (aside or (len(items) == 1 and phrase.dimensions))):
                last.qualifiers |= phrase.qualifiers
                self.current = last
                return last
        words = self.text[phrase.start : phrase.end].strip(" \t:,.-–—") if phrase.name else ""
        group = Group(phrase.name or "overall", words, set(phrase.qualifiers))
        if len(items) == 1 and (is_base(group.name) or is_detail(group.name)):
            # "mouth diameter: 14 cm, diameter: 38 cm": an opening is measured across, and nothing else of it; so is a
            # base where its name is no heading.
            heads = any(self.tokens[at].type == COLON for at in self.label)
            across = items[0].dimension == "diameter" and (is_opening(group.name) or not heads)
            group.aside = across or bool(phrase.dimensions) or not items[0].dimension
        elif len(items) == 1 and phrase.name and not (phrase.dimensions or items[0].dimension):
            group.aside = any(_is_whole(other) for other in self.groups)  # length 60 cm; boom 20 cm; height 30 cm
        elif len(items) == 1 and phrase.name and phrase.dimensions and group.name != "overall":
            state = group.name.startswith(_BEHIND)
            group.aside = any(other.name == "overall" if state else not other.aside for other in self.groups)
        group.aside = group.aside or (bool(phrase.name) and self._is_bracketed())
        self.groups.append(group)
        self.current = group
        self.open = []
        return group

    def _is_bracketed(self) -> bool:
        """Whether numbers stand in brackets behind others: "Length: 235 cm (net 232 cm); Width: 94 cm"."""
        kinds = [self.tokens[at].type for at in self.label]
        return not self.fresh and kinds.count(OPEN) > kinds.count(CLOSE)

    def _target(self, phrase: Phrase, items: list[DimensionQuantity]) -> Group | None:
        """Return the group that a phrase's numbers may go on with: one of its name; without a name, the last whole."""
        if phrase.name:
            last = self.current
            if last is None or last.name != phrase.name:
                return None
            return last if phrase.dimensions or (last.words and all(item.dimension for item in items)) else None
        return next((group for group in reversed(self.groups) if not group.aside), None)

    def _apply(self, phrase: Phrase, items: list[DimensionQuantity]) -> None:
        """Give numbers the dimensions that a phrase names: a legend to all, one dimension to a single number."""
        if phrase.joined and len(phrase.dimensions) == len(items):
            for item, dimension in zip(items, phrase.dimensions, strict=True):
                item.dimension = item.dimension or dimension
        elif phrase.dimensions and len(items) == 1 and not items[0].dimension:
            items[0].dimension = phrase.dimensions[-1]

    def _brackets(self, at: int) -> int:
        """Read a remark in brackets right behind numbers, such as (irreg.), (h x w) or (framed)."""
        tokens = self.tokens
        end = at + 1
        while tokens[end].type in (WORD, DIMENSION, DOT, COMMA, JOIN) or (
            tokens[end].type == NUMBER and tokens[end + 1].type == WORD and tokens[end + 1].unit is None
        ):
            end += 1
        following = tokens[end + 1].type if tokens[end].type == CLOSE else COLON
        phrase = phrase_of(tokens, list(range(at, end)), self.text)
        remark = phrase.qualifiers or phrase.dimensions or phrase.name
        ends = following in (END, BREAK, COMMA, DOT)
        if following == COMMA and tokens[end + 2].type == DIMENSION and not phrase.known and phrase.name:
            start, stop = tokens[at + 1].start, tokens[end - 1].end
            self.notes.append(
                DimensionNote("remainder", f"not understood: {self.text[start:stop][:80]!r}", start, stop)
            )
            return end + 1
        if following in (COLON, NUMBER) or not remark or (phrase.name and not (phrase.known and ends)):
            self.label.append(at)
            return at + 1
        self._behind(phrase)
        return end + 1

    def _is_sentence(self) -> bool:
        """Say whether a full stop ends a remark such as "Various composition dimensions. Sheet ..."."""
        before = self.tokens[self.label[-2]] if 1 < len(self.label) <= _LONGEST_REMARK else None
        return (
            before is not None
            and before.meaning in (("filler", ""), ("qualifier", "variable"))
            and (len(before.word) > 3 and any(self.tokens[i].meaning == ("qualifier", "variable") for i in self.label))
        )

    def _is_remark(self) -> bool:
        """Say whether the words since the last number belong to that number, and are not the next one's label."""
        if len(self.label) > _LONGEST_REMARK or any(self.tokens[i].type == COLON for i in self.label):
            return False
        phrase = phrase_of(self.tokens, self.label, self.text)
        behind = phrase.name.startswith(_BEHIND)
        return behind or (not phrase.name and bool(phrase.dimensions or phrase.qualifiers))

    def _trails(self, comma: int) -> bool:
        """Say whether words right behind a labelled number are its own: "Width: 21 cm handle to spout, Height:"."""
        tokens = self.tokens
        first, group = self.label[0], self.current
        following = tokens[comma + 1].type == DIMENSION and tokens[comma + 2].type in (COLON, NUMBER)
        if group is None or not following or not group.quantities[-1].dimension or len(self.label) > _LONGEST_REMARK:
            return False
        if first == 0 or tokens[first - 1].type not in (UNIT, NUMBER, DOT, CLOSE):
            return False
        return not any(tokens[at].type in (COLON, COMMA, DIMENSION) for at in self.label)

    def _break(self, at: int) -> None:
        """End a clause at a semicolon, a line at a line break; a heading's words wait for the next line."""
        line = self.tokens[at].word != ";"
        heading = self.label and self.tokens[self.label[-1]].type == COLON
        if not (line and heading):
            self._remark()
        self.fresh = self.fresh or line
        self.open = []

    def _remark(self) -> None:
        """Use words that no number follows: for the numbers before them, as a note, or as the unread remainder."""
        label, self.label = self.label, []
        words = [at for at in label if self.tokens[at].type not in _ASIDE and self.tokens[at].word not in _STRAY]
        if all(self.tokens[at].meaning == ("filler", "") for at in words):
            return
        phrase = phrase_of(self.tokens, words, self.text)
        # "25 cm high, and 12 wide": what has a number of its own is not said of the numbers before it.
        counts = bool(phrase.dimensions) and any(self.tokens[at].type == NUMBER for at in words)
        if self.groups and not self.fresh and not counts and self._behind(phrase):
            return
        start, end = self.tokens[words[0]].start, self.tokens[words[-1]].end
        if "variable" in phrase.qualifiers:
            self.notes.append(DimensionNote("variable", "dimensions are said to vary", start, end))
        else:
            self.notes.append(DimensionNote("remainder", f"not understood: {self.text[start:end][:80]!r}", start, end))

    def _behind(self, phrase: Phrase) -> bool:
        """Apply a phrase that stands behind numbers to them; say whether there was any use for it."""
        group = self.current or self.groups[-1]
        use = False
        if phrase.dimensions:
            run = [q for q in group.quantities if q.run == group.quantities[-1].run]
            if phrase.joined and len(run) == len(phrase.dimensions):
                self._apply(phrase, run)
            elif not run[-1].dimension:
                run[-1].dimension = phrase.dimensions[-1]
            use = True
        name = phrase.name
        if phrase.on or (name.endswith(" base") and not phrase.dimensions and not name.startswith("with")):
            name = "with base"  # "on wooden base" without numbers of its own
        if phrase.known and (is_base(name) or is_detail(name)):
            group = self._split(group, phrase)
        stands = phrase.known or name.startswith(_BEHIND)
        stands = stands or ("each" in phrase.qualifiers and not group.words)
        if name and stands and (group.name != "overall" or name.startswith(_BEHIND)) and self._again(group, phrase):
            use = True
        elif name and stands and group.name == "overall":
            group.name = name
            group.words = self.text[phrase.start : phrase.end].strip(" \t:,.()")
            group.aside = group.aside or (len(group.quantities) == 1 and is_opening(name))
            use = True
        elif name in _STATES:
            group.name = f"{group.name} {name}"
            use = True
        elif phrase.name and not phrase.dimensions:
            return False
        if phrase.qualifiers and "variable" not in phrase.qualifiers:
            group.qualifiers |= phrase.qualifiers
            use = True
        return use

    def _again(self, group: Group, phrase: Phrase) -> bool:
        """Part the last number from a group where a remark names it otherwise: "H: 30 cm, 36 cm (with base)"."""
        *before, last = group.quantities
        if last.dimension or len(before) != 1 or before[0].run == last.run or not before[0].dimension:
            return False
        last.dimension = before[0].dimension
        group.quantities = before
        words = self.text[phrase.start : phrase.end].strip(" \t:,.()")
        self.current = Group(phrase.name, words, set(phrase.qualifiers), [last], aside=True)
        self.groups.append(self.current)
        return True

    def _split(self, group: Group, phrase: Phrase) -> Group:
        """Give the last number of a group one of its own: in "H. 12 cm, Diam. 8 cm (rim)" only it is the rim's."""
        last = [q for q in group.quantities if q.run == group.quantities[-1].run]
        if last[-1].dimension == "diameter" and is_opening(phrase.name) and all(q.dimension for q in last):
            last = last[-1:]  # "h 17 cm x diameter 9 cm (foot)": what is round is the foot, what is high the whole
        elif len(phrase.dimensions) == 1 and last[-1].dimension and not any(q.dimension for q in last[:-1]):
            last = last[-1:]  # '16 x 5 x 4 in. diam. at base': one dimension is of one number
        if group.name != "overall" or len(last) == len(group.quantities) or len(last) > 1:
            return group
        group.quantities = [q for q in group.quantities if q not in last]
        for q in last:
            q.run = self.runs
        self.runs += 1
        self.current = Group("overall", "", set(phrase.qualifiers), last, aside=True)
        self.groups.append(self.current)
        return self.current

    def _leave_out(self, at: int, behind: int, what: str) -> int:
        """Note something that is no dimension, with the words before it and its unit; return the token behind it."""
        tokens = self.tokens
        words = [i for i in self.label if tokens[i].type not in _ASIDE]
        start = tokens[words[0]].start if words else tokens[at].start
        self.label = []
        while tokens[behind].type in (UNIT, DOT) or tokens[behind].word in ("per", "second", "a"):
            behind += 1
        end = tokens[behind - 1].end
        self.notes.append(DimensionNote("left_out", f"{what}: {self.text[start:end][:80]!r}", start, end))
        return behind
