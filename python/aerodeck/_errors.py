"""What can go wrong, said so that a user can mend it."""


class AerodeckError(Exception):
    """Any error of this package."""


class AerodeckWarning(UserWarning):
    """Something given that is possible but implausible, as in another unit, notation or axis."""


class InputError(AerodeckError, ValueError):
    """Wrong input: the caller can mend it.

    Attributes
    ----------
    file : str or None
        File in which the problem stands, if it came from one.
    place : str
        Line, key, column or argument, in words.
    expected, found : str
        What would have been accepted, and what stood there.
    """

    def __init__(self, file, place, expected, found):
        self.file, self.place, self.expected, self.found = file, place, expected, found
        where = "".join(f"{part}: " for part in (file, place) if part)
        super().__init__(f"{where}expected {expected}, found {found}")

    def __reduce__(self):
        return type(self), (self.file, self.place, self.expected, self.found)


class FileError(AerodeckError, OSError):
    """A file could not be read or written; `file` names it."""

    def __init__(self, file, reason):
        self.file, self.reason = file, reason
        super().__init__(f"{file}: {reason}")

    def __reduce__(self):
        return type(self), (self.file, self.reason)


class NumericalError(AerodeckError, ArithmeticError):
    """A computation did not reach a usable result."""


class UnstableError(AerodeckError):
    """The section grows where only a stable one has an answer, or may be exported."""
