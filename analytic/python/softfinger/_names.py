"""Names that are not known, and the known ones that were probably meant."""

import difflib
import functools
import inspect


def did_you_mean(name, known):
    """ "; did you mean NAME?" for the nearest of the known names, "" where none is near."""
    if not isinstance(name, str) or not name:
        return ""
    by_lower = {one.lower(): one for one in known}
    near = difflib.get_close_matches(name.lower(), by_lower, 1)
    # A word of a long name is far from it by difflib's measure: "friction", "radius_major".
    near = near or [lower for lower in by_lower if name.lower() in lower]
    return f"; did you mean {by_lower[near[0]]}?" if near else ""


def choices(name, known):
    """What is allowed in place of an unknown name, for an InputError."""
    return ", ".join(known) + did_you_mean(name, known)


def unknown_attribute(owner, name, known):
    """What an object's or a module's `__getattr__` raises."""
    public = [one for one in known if not one.startswith("_")]
    return AttributeError(f"{owner} has no {name!r}{did_you_mean(name, public)}")


def unexpected(function, name, known):
    """What a call with an unknown keyword raises, in Python's own words."""
    return TypeError(
        f"{function}() got an unexpected keyword argument {name!r}{did_you_mean(name, known)}"
    )


def suggests_keywords(function):
    """Makes a function say which keyword was probably meant by one that it does not have."""
    known = inspect.signature(function).parameters

    @functools.wraps(function)
    def of_known(*arguments, **keywords):
        for name in keywords:
            if name not in known:
                raise unexpected(function.__name__, name, known)
        return function(*arguments, **keywords)

    return of_known
