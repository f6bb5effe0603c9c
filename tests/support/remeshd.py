"""A real remeshd, for tests and measurements in Python."""

import json
import os
import subprocess
import threading


class Daemon:
    """remeshd on a free port, for the length of a `with`."""

    def __init__(self, program, *flags, key=None):
        environment = {name: value for name, value in os.environ.items() if not name.startswith("REMESHD_")}
        environment["REMESHD_STORE"] = "none"  # unless a flag says another
        if key:
            environment["REMESHD_API_KEY"] = key
        command = [program, "--bind", "127.0.0.1:0", "--log-format", "json", *flags]
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, env=environment, text=True)
        self.log = []
        self.port = int(json.loads(self.process.stderr.readline())["address"].rsplit(":", 1)[1])
        threading.Thread(target=self._read_log, daemon=True).start()

    def _read_log(self):
        for line in self.process.stderr:
            self.log.append(json.loads(line))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
