"""House rules: what the museum states once for all objects that a rule matches, and what they come to for one object.

A rule matches an object by its number (a pattern), class, gallery, medium (words) and support: all that it names must
hold.  For each quantity by itself the most particular of the rules that match and say something of it is taken:

1.  a whole number before a pattern, a pattern with more characters before one with fewer, both before none;
2.  then the rule that names more of class, gallery and medium;
3.  then the one that names the support.

Rules that are equally particular and say different things are an error, told of the object and by `kouros check`:
neither is taken.  What the record of an object says is taken before any rule.
"""
