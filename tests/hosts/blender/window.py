# SPDX-License-Identifier: MIT
"""What does the operator do in a Blender with a window? Its own functions, called as Blender calls them, with a stand-in for
the window, a real program beside it, and events that a user would cause."""

import os
import time
import types

import bpy

PATIENCE_S = 60


class Recorder:
    """A stand-in that notes every call: calls[i] = (name, arguments)."""

    def __init__(self, **answers):
        self.calls, self._answers = [], answers

    def __getattr__(self, name):
        def call(*arguments, **named):
            self.calls.append((name, arguments))
            return self._answers.get(name)

        return call

    def said(self, name):
        return [arguments for called, arguments in self.calls if called == name]


class Window:
    """bpy.context with a window: the manager and the status bar note what they are told."""

    def __init__(self):
        self.window, self.window_manager, self.workspace = object(), Recorder(event_timer_add="timer"), Recorder()

    def __getattr__(self, name):
        return getattr(bpy.context, name)


def operator(path):
    """An export that Blender has begun: the functions of the class, as it is no type that Python can call."""
    from hemibake import operator as module

    # Only this module believes in a window.
    module.bpy = types.SimpleNamespace(app=types.SimpleNamespace(background=False))
    stand = types.SimpleNamespace(filepath=path, _timer=None, reports=[])
    stand.report = lambda kind, text: stand.reports.append((sorted(kind)[0], text))
    for name in ("execute", "start", "modal", "finish", "clean_up"):
        setattr(stand, name, types.MethodType(getattr(module.ExportHemibake, name), stand))
    return stand


def event(kind):
    return types.SimpleNamespace(type=kind)


def drive(export, window, until=lambda: False):
    """Timer events until the export ends, or until something is so; what the last one returned."""
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        answer = export.modal(window, event("TIMER"))
        if answer != {"PASS_THROUGH"} or until():
            return sorted(answer)[0]
        time.sleep(0.02)
    raise TimeoutError("the export does not end")


def outcome(export, window, answer):
    """What a test asks of an export that is over."""
    manager = window.window_manager
    return {
        "answer": answer,
        "reports": export.reports,
        "progress": [share for (share,) in manager.said("progress_update")],
        "status": [text for (text,) in window.workspace.said("status_text_set")],
        "timer gone": manager.said("event_timer_remove") == [("timer",)] and len(manager.said("progress_end")) == 1,
        "file": os.path.exists(export.filepath),
        "folder": os.path.exists(export.folder),
        "running": export.run._process.poll() is None,
    }


def begin(path):
    export, window = operator(path), Window()
    answer = export.execute(window)
    assert answer == {"RUNNING_MODAL"}, (answer, export.reports)
    assert window.window_manager.said("modal_handler_add") == [(export,)]
    return export, window


def whole(path):
    """Left alone, it ends by itself; a moving mouse is none of its business."""
    export, window = begin(path)
    passed = export.modal(window, event("MOUSEMOVE")) == {"PASS_THROUGH"}
    return outcome(export, window, drive(export, window)) | {"passed": passed}


def escaped(path):
    """Esc when progress has been read from the program."""
    export, window = begin(path)
    drive(export, window, until=lambda: export.run.fraction > 0)
    return outcome(export, window, sorted(export.modal(window, event("ESC")))[0])


def killed(path):
    """Somebody else ends the program."""
    export, window = begin(path)
    drive(export, window, until=lambda: export.run.fraction > 0)
    export.run._process.kill()
    return outcome(export, window, drive(export, window))


def refused(path):
    """The program itself says no."""
    export, window = begin(path)
    return outcome(export, window, drive(export, window))


def not_begun(path):
    """Nothing to begin: an error at once, and neither timer nor progress."""
    export, window = operator(path), Window()
    return {"answer": sorted(export.execute(window))[0], "reports": export.reports, "calls": window.window_manager.calls}
