"""Every number that the models of one scene need, with its origin, and what is missing for them."""

from dataclasses import replace

from pipeline.analysis.bodies import SOFT, stands_deep
from pipeline.analysis.flexibility import Body, concentration, estimated_frequency
from pipeline.analysis.footing import base_extents, half_widths, rolling
from pipeline.analysis.furniture import furniture_of
from pipeline.analysis.hanging import HangingGuess, hanging_estimates, hanging_of, swings
from pipeline.analysis.house.matching import HouseEffect
from pipeline.analysis.masses import mass_of, solid_mass
from pipeline.analysis.mounts import MountGuess, mount_estimates
from pipeline.analysis.section import Section, section_of, share_of
from pipeline.analysis.sizes import PLAN, Sizes
from pipeline.analysis.told import held_behind, line_of
from pipeline.analysis.usual import base_of, clearance_of, friction_of, own_damping, shelved, wall_damping_of
from pipeline.models.rigid_body import FALLS_IN, HALF
from pipeline.models.unhooking import LOCKED
from pipeline.records import Estimate, Furniture, Item, Origin, Support
from pipeline.records import phrases as say
from pipeline.tables.assumed import UNKNOWN, AssumedValues, assumed
from pipeline.tables.assumed_rows import Material, ObjectClass
from pipeline.tables.body_rows import BodyRow
from pipeline.tables.limit_rows import HELD_ABOVE, limit

FROM_ABOVE = "chandelier"
"""Class of which the room is taken of what hangs from above in a room: nothing stands as near as beside what stands."""

LAMP, GLASS = "lamp", "glass"
"""Class of which a shade or drops of glass are borne by a stem that is of metal where the record names one."""

_CORD = 1.0
"""How much longer a cord from a rail may make what a work hangs by than its upper edge [m], by judgement."""


def material_of(item: Item, values: AssumedValues | None = None) -> Material:
    """Return what an object is made of: the material whose word stands first in its record.

    Parameters
    ----------
    values : AssumedValues or None, optional
        The tables that know the words; None for Kouros's own.

    Returns
    -------
    Material
    """
    values = values or assumed()
    return values.material_in(item.material or item.medium) or values.materials[UNKNOWN]


def bearing_of(item: Item, row: ObjectClass, values: AssumedValues) -> Material:
    """Return what the weakest section of an object is made of: of a lamp of glass and bronze its stem is of bronze.

    Parameters
    ----------
    item : Item
        Its record.
    row : ObjectClass
        Its class.
    values : AssumedValues
        The tables that know the words.
    """
    first = material_of(item, values)
    if row.name != LAMP or first.name != GLASS:
        return first
    return next((one for one in values.materials_in(item.material or item.medium) if one.ductile), first)


def _measured(value: float | None, unit: str) -> Estimate | None:
    return None if value is None else Estimate.measured(value, unit)


def _own_base(row: ObjectClass) -> bool:
    """Say whether the museum's own row of a class states the base, and does not leave it as it was."""
    kouros = assumed().classes.get(row.name)
    cells = ("base_low", "base_ratio", "base_high")
    return bool(row.own) and (kouros is None or any(getattr(row, one) != getattr(kouros, one) for one in cells))


class SceneParameters:
    """Collects the parameters of one scene, and what is missing for them.

    Parameters
    ----------
    item : Item
        The record, as it stands on its floor.
    row : ObjectClass
        What is assumed of its class, of its shape where that is known.
    support : Support
        How it is held, recorded or assumed.
    values : AssumedValues
        All tables of what is assumed.
    house : HouseEffect
        What the museum's house rules come to for it.
    mount : MountGuess or None
        What holds it, where it does not stand by itself.
    shape : BodyRow, optional
        What kind of body it is beside its class.

    Attributes
    ----------
    found : dict of str to Estimate
        The parameters by name, in the units of the models (SI).
    missing : list of str
        What must be recorded for the models to run.
    doubts : list of str
        Assumptions that are no number.
    hanging : HangingGuess or None
        How it hangs, where it is hung on a wall.
    """

    def __init__(
        self,
        item: Item,
        row: ObjectClass,
        support: Support,
        values: AssumedValues,
        house: HouseEffect,
        mount: MountGuess | None,
        shape: BodyRow | None = None,
    ) -> None:
        self.mount, self.shape = mount, shape
        self.sizes = Sizes.of(item, row, deep=None if shape is None else stands_deep(shape))
        # All is found with the best of what is not recorded, and then made as uncertain as that is.
        self.item, self.row, self.support, self.values, self.house = self.sizes.filled, row, support, values, house
        self.material = material_of(item, values)
        self.bearing = bearing_of(item, row, values)
        self.hanging: HangingGuess | None = None
        if support is Support.HUNG:
            told = house.stated.get("hanging")
            self.hanging = hanging_of(item, row.name, house.hanging(item), "" if told is None else told.origin)
        self.found: dict[str, Estimate] = {}
        self.missing: list[str] = []
        self.doubts: list[str] = []
        self.hangs_on: set[str] = set()

    def build(self) -> None:
        """Find all of them: of what hangs, of what a mount holds, or of what stands."""
        if self.support in (Support.HUNG, Support.SUSPENDED):
            self._hanging()
        elif self.mount is not None and not self.mount.stands:
            self._mounted(self.mount)
        else:
            self._standing()
        self._clearance()
        self.found |= self.sizes.used(self.hangs_on)

    def _spread(self, name: str, *sizes: str, power: float = 1.0, cause: str = "") -> None:
        """Make a number that was found as uncertain as the sizes that it hangs on and that are not recorded."""
        if name in self.found and self.sizes.used(sizes) and self.found[name].origin is not Origin.MEASURED:
            self.found[name] = self.sizes.spread(self.found[name], sizes, power, cause)
            self.hangs_on.update(sizes)

    def _keep(self, name: str, estimate: Estimate | None) -> None:
        if estimate is not None:
            self.found[name] = estimate

    def _known(self, name: str, what: str, unit: str) -> Estimate | None:
        """Return what the record says of a field, or else what a house rule states."""
        recorded = _measured(getattr(self.item, name), unit)
        stated = self.house.stated.get(name)
        return stated.estimate(what, unit) if recorded is None and stated is not None else recorded

    def _hanging(self) -> None:
        if self.hanging is not None:
            self.found |= hanging_estimates(self.item, self.hanging)
            for name in ("hook_height", "gyration"):
                self._spread(name, "height", cause="hook_height")
            self._spread("hook_offset", "depth")
        if self.hanging is None or swings(self.hanging):
            self._pendulum()
        elif self.item.height_m is None and "hook_depth" not in self.found and self.hanging.known not in LOCKED:
            self.missing.append("height")
        self._weigh("height", "width", *(() if self.row.filled is None else ("depth",)))

    def _pendulum(self) -> None:
        item = self.item
        length = self._length("suspension_length_m", "suspension_ratio", "length from hook to centre of gravity")
        line = line_of(item.displayed) if self.support is Support.SUSPENDED else None
        if length is None and item.height_m is None:
            self.missing.append("height or suspension length")
        elif length is None and item.height_m is not None:
            half = 0.5 * item.height_m
            note = f"{say.LENGTH_FROM_HOOK()}; {say.OTHER_HOOKS(more=_CORD)}"
            length = Estimate.assumed(half, 0.5 * half, half + _CORD, "m", note, "judgement")
            if line is not None:
                note = say.LENGTH_DISPLAYED(line=line)
                length = Estimate(line + half, "m", Origin.DERIVED, line, line + 2.0 * half, note)
        self._keep("length", length)
        if item.suspension_length_m is None and line is None:
            self._spread("length", "height")
        damping = self._known("damping", "damping", "-")
        if damping is None and self.support is Support.HUNG:
            damping = wall_damping_of(self.values, item.wall_surface, item.back_surface)
        elif damping is None:
            source = "Agbabian et al. 1991, sec. 2.4"
            damping = Estimate.assumed(0.0, 0.0, 0.0, "-", say.NO_DAMPING(), source)
        self._keep("damping", damping)

    def _standing(self) -> None:
        item = self.item
        width, depth, lost = self._plan()
        cg = self._length("cg_height_m", "cg_ratio", "height of the centre of gravity")
        if cg is None and item.height_m is not None and self.row.cg is not None:
            cg = share_of(self.row, self.row.cg, item.height_m, "m", "height of the centre of gravity", "height")
        if cg is None:
            self.missing.append("height" if self.row.cg is not None else "height of the centre of gravity")
        self._keep("cg_height", cg)
        if item.cg_height_m is None and self._stated_as("cg_height_m") != "cg_height_m":
            self._spread("cg_height", "height")
            cg = self.found.get("cg_height")
        whole = _own_base(self.row) or self.shape is not None
        halves = half_widths(item, "" if whole else self.row.name, width, depth, cg)
        self.found |= halves
        soft = self.material.name in SOFT
        if item.susceptible is None and (soft or not self.row.rocking_harms):
            note = say.NO_HARM_BY_ROCKING(told=self.material.told if soft else self.row.told)
            source = f"{self.row.table}, {self.row.name} ({self.row.source})"
            self._keep(FALLS_IN, Estimate.assumed(HALF, HALF, HALF, "-", note, source))
        self._friction()
        self._weigh("height", "width", "depth")
        if not self._section(width, depth) and self.support is Support.FASTENED:
            # What is made fast is judged by its weakest section alone.
            self.missing.extend(lost if self.row.section else ["width of its weakest section"])
            if "mass" not in self.found:
                self.missing.append("mass")
        elif self.support is not Support.FASTENED and not halves:
            self.missing.extend(lost)
        self._keep("frequency", self._known("frequency_hz", "lowest natural frequency", "Hz"))
        if "frequency" in self.found:
            self._keep("damping", self._known("damping", "damping of the object itself", "-") or own_damping())

    def _mounted(self, mount: MountGuess) -> None:
        self.found |= mount_estimates(mount, self.row, self.sizes)
        if "friction_static" not in self.found:
            self._friction()
        self._weigh("height", "width", "depth")
        self.hangs_on.update(self.sizes.assumed if {"mass", "half_width"} & self.found.keys() else ())
        if mount.models_need_size and "half_width" not in self.found:
            self.missing.append("height")

    def _length(self, name: str, share: str, what: str) -> Estimate | None:
        """Return a length that is recorded, or stated as such or as a share of the height."""
        stated, height = self.house.stated.get(name), self.item.height_m
        if getattr(self.item, name) is None and stated is not None and stated.field == share:
            return None if height is None else stated.estimate(what, "m", height)
        return self._known(name, what, "m")

    def _stated_as(self, about: str) -> str:
        """Return as which field a house rule states a thing; "" where none does."""
        stated = self.house.stated.get(about)
        return "" if stated is None else stated.field

    def _plan(self) -> tuple[Estimate | None, Estimate | None, list[str]]:
        """Return the sides of its base, None where they are not known, and what must be recorded to know them."""
        item, row = self.item, self.row
        scanned = base_extents(item)
        if scanned is not None:
            return *scanned, []
        share = self.house.stated.get("base_ratio")
        assumes = row.base is not None or share is not None
        sides: list[Estimate | None] = []
        pairs = ((item.base_width_m, item.width_m, "width"), (item.base_depth_m, item.depth_m, "depth"))
        for measured, largest, name in pairs:
            side = _measured(measured, "m")
            if side is None and largest is not None and share is not None:
                side = share.estimate(f"base {name}", "m", largest)
            elif side is None and largest is not None and row.base is not None:
                side = share_of(row, row.base, largest, "m", f"base {name}", name)
            if side is not None and measured is None and self.sizes.used((name,)):
                side = self.sizes.spread(side, (name,))
                self.hangs_on.add(name)
            sides.append(side)
        width, depth = sides
        if width is None and depth is None:
            return None, None, ["width (or diameter)"] if assumes else ["base width", "base depth"]
        if width is None or depth is None:
            known, lost = (width, "depth") if depth is None else (depth, "width")
            if not row.round or known is None:
                return None, None, [lost if assumes else f"base {lost}"]
            note = say.ROUND(size=lost)
            source = known.source or f"{row.table}, {row.name}"
            other = Estimate.assumed(known.value, known.low, known.high, "m", note, source)
            return (known, other, []) if depth is None else (other, known, [])
        return width, depth, []

    def _friction(self) -> None:
        item = self.item
        friction = self._known("friction", "friction", "-")
        wheels = rolling(item, self.row.name)
        if friction is None and wheels is not None:
            friction = wheels.rolls
        elif friction is None:
            material = base_of(self.values, item) or self.material.friction_as
            friction = friction_of(self.values, material, item.surface_material, self._stands_on())
        self._keep("friction_static", friction)

    def _stands_on(self) -> Furniture | None:
        return furniture_of(self.item, self.row.name, self.support, self.house).furniture

    def _clearance(self) -> None:
        clearance = self._known("clearance_m", "clearance", "m")
        if clearance is None and "clearance" not in self.found:
            above = self.support is Support.SUSPENDED and not self.row.own
            # Within a case the glass is as near to it as to what stands there.
            hangs = above and self._stands_on() is not Furniture.SHOWCASE
            clearance = shelved(self.item, self.row) or clearance_of(
                self.values, FROM_ABOVE if hangs else self.row.name
            )
        self._keep("clearance", clearance)

    def _weigh(self, *sizes: str) -> None:
        """Keep its mass, which hangs on these sizes."""
        self._mass()
        self._spread("mass", *sizes, cause="half_width" if self.sizes.used(PLAN) else "cg_height")

    def _mass(self) -> None:
        thick = "depth" not in self.sizes.assumed
        self._keep("mass", mass_of(self.item, self.row, self.material, self.support, self.shape, thick=thick))

    def _section(self, width: Estimate | None, depth: Estimate | None) -> bool:
        """Keep what the stress in the weakest section hangs on; say whether all of it is known."""
        item = self.item
        condition = 1.0 if item.condition is None else item.condition
        allowable = _measured(item.allowable_stress_pa, "Pa")
        if allowable is None:
            bears = self.bearing.tensile_range
            note = say.STRESS_UNSEEN(material=self.bearing.told, stress=bears)
            if item.condition is not None:
                note = say.STRESS(material=self.bearing.told, stress=bears, factor=condition)
            allowable = Estimate.assumed(
                bears.value * condition, bears.low * condition, bears.high * condition, "Pa", note, bears.source
            )
        found = section_of(item, self.row, width, depth)
        self.missing.extend(found.missing)
        self.doubts.extend(found.doubts)
        mass, cg = self.found.get("mass"), self.found.get("cg_height")
        if mass is None or cg is None or found.section is None:
            return False
        self._keep("allowable_stress", allowable)
        height = item.section_height_m or 0.0
        note = say.LEVER(start="section" if height else "base")
        low, lever, high = (max(one - height, 0.0) for one in (cg.low, cg.value, cg.high))
        self._keep("lever", Estimate(lever, "m", Origin.DERIVED, low, high, note))
        self.found |= found.section.estimates(item.orientation_deg is not None)
        shaped = self.shape is not None and self.shape.fill is not None
        solid = None if shaped else solid_mass(item, self.row, self.bearing, mass)
        self._keep("solid_mass", solid)
        if solid is not None:
            # What bends is as stiff for its mass as the solid one.
            low, value, high = (max(one, solid.value) for one in (mass.low, mass.value, mass.high))
            mass = replace(mass, low=low, value=value, high=high)
        self._bending(found.section, mass, cg)
        if found.section.width.origin is Origin.ASSUMED:
            self._spread("section_modulus", self.sizes.narrow, power=3.0, cause="half_width")
            self._spread("frequency", self.sizes.narrow)
        self._spread("frequency", "height", power=-1.5)
        if held_behind(item, self.support):
            self._braced()
        return True

    def _braced(self) -> None:
        """Let it bend less and sway faster: it is held above its base too."""
        bends = limit("braced_bending")
        for name, factors in (("lever", bends), ("frequency", limit("braced_stiffness"))):
            one = self.found.get(name)
            if one is not None and one.origin is not Origin.MEASURED:
                note = ", ".join(filter(None, (one.note, HELD_ABOVE)))
                self.found[name] = one.times(factors.low, factors.value, factors.high, note)
        self.doubts.append(say.HELD_BEHIND(factor=bends))

    def _bending(self, section: Section, mass: Estimate, cg: Estimate) -> None:
        """Keep what its bending hangs on besides: how its base is held, and its frequency where that is estimated."""
        item = self.item
        if self.support is Support.FASTENED:
            self._keep("concentration", concentration(item, self.bearing))
        if self._known("frequency_hz", "lowest natural frequency", "Hz") is None:
            body = Body(section, mass, cg, item.height_m, item.section_height_m or 0.0, item.width_m or item.depth_m)
            self._keep("frequency", estimated_frequency(body, self.row, self.bearing))
