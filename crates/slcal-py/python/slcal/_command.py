"""The `slcal` command of the wheel: the same program as the Rust binary."""

import signal
import sys

from ._slcal import run_command


def main() -> None:
    """Run the command line of this process and exit with its code."""
    # Ctrl-C ends the program at once: Python's own handler would wait for the extension to return.
    # Where it is ignored, as by `nohup` or a shell's `&`, it stays so.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(run_command(sys.argv))
