"""Signals as a terminal sets them, whoever runs the tests: what is ignored (`nohup`, a shell's `&`) is inherited by every process
that a test starts, and some of them are to be ended by a signal."""

import signal

signal.signal(signal.SIGINT, signal.default_int_handler)
for name in ("SIGTERM", "SIGHUP"):
    if hasattr(signal, name):
        signal.signal(getattr(signal, name), signal.SIG_DFL)
