"""``python -m slcal``: the `slcal` command of this interpreter's package."""

from ._command import main

if __name__ == "__main__":
    main()
