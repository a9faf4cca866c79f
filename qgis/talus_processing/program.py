"""The program talus: where it is, and a run of it with progress, messages and cancelling."""

import json
import os
import pathlib
import queue
import shlex
import shutil
import signal
import subprocess
import threading

from processing.core.ProcessingConfig import ProcessingConfig
from qgis.core import QgsProcessingException

SETTING = "TALUS_PROGRAM"
WHERE_SET = "Settings > Options > Processing > Providers > talus"
INTERRUPTED = 130  # exit code


def find_program():
    """The program that the setting names; without one, that of the installation which this file is part of, or else
    the first in PATH."""
    named = ProcessingConfig.getSetting(SETTING)
    if named:
        if os.path.isfile(named) and os.access(named, os.X_OK):
            return named
        raise QgsProcessingException(f"{named}: is not a program; {WHERE_SET} names it as the program talus")
    here = pathlib.Path(__file__).resolve().parent  # <prefix>/share/qgis/python/plugins/talus_processing
    installed = here.joinpath("../../../../../bin/talus").resolve()
    if os.path.isfile(installed) and os.access(installed, os.X_OK):
        return str(installed)
    found = shutil.which("talus")
    if found is None:
        raise QgsProcessingException(
            f"the program talus was not found: neither {installed} nor any folder of PATH has it; "
            f"install it, or name it at {WHERE_SET}"
        )
    return found


def _pass_on(stream, lines):
    for line in stream:
        lines.put(line.rstrip("\n"))
    lines.put(None)


def _show_progress(event, feedback):
    share = event.get("share_done_of_all_runs", event.get("share_done"))
    if share is None and event.get("runs_at_most"):
        share = (event["runs_done"] + event["runs_failed"]) / event["runs_at_most"]
    if share is not None:
        feedback.setProgress(100 * share)
    if "time_s" in event:
        text = f"{event['time_s']:.1f} s of debris flow"
    else:
        text = f"{event.get('runs_done', 0)} of {event.get('runs', event.get('runs_at_most'))} runs"
    left = event.get("wall_remaining_of_all_runs_s", event.get("wall_remaining_s"))
    feedback.setProgressText(text if left is None else f"{text}, about {left:.0f} s left")


def run_program(arguments, feedback):
    """Runs talus to its end. Its lines go to the log; returns what it printed. Cancelling interrupts it as Ctrl-C does,
    so that it writes the results so far. Errors: QgsProcessingException with the program's own sentence."""
    command = [find_program(), *arguments]
    feedback.pushCommandInfo(shlex.join(command))
    # A session of its own: Ctrl-C in the terminal of QGIS is for QGIS.
    process = subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8",
        errors="replace", start_new_session=True,
    )  # fmt: skip
    lines = queue.Queue()
    threading.Thread(target=_pass_on, args=(process.stdout, lines), daemon=True).start()
    text, error, told = [], "", False
    while True:
        if feedback.isCanceled() and not told:
            process.send_signal(signal.SIGINT)
            told = True
        try:
            line = lines.get(timeout=0.1)
        except queue.Empty:
            continue
        if line is None:
            break
        event = json.loads(line) if line.startswith("{") else None
        if event is None:
            text.append(line)
            error = line.partition("talus: error: ")[2] or error
            feedback.pushInfo(line)
        elif event["event"] == "progress":
            _show_progress(event, feedback)
    process.stdout.close()
    code = process.wait()
    if code == INTERRUPTED:
        feedback.pushInfo("cancelled")
    elif code != 0:
        raise QgsProcessingException(error or f"talus ended with code {code}")
    return "\n".join(text)
