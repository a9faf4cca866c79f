"""Opens this run of talus in ParaView: ground, structures, the surface of the debris and its particles.

In ParaView: File > Load State, and choose this file. Or on the command line: paraview --script=run.py
"""
import os

from paraview.simple import *


def folder_of_this_file():
    """ParaView does not tell every script where it lies."""
    names = [globals().get("__file__", "")]
    if os.path.exists("/proc/self/cmdline"):
        with open("/proc/self/cmdline") as words:
            names += [word.split("=", 1)[-1] for word in words.read().split("\0")]
    folders = [os.path.dirname(os.path.abspath(name)) for name in names if name.endswith(".py")]
    for folder in folders + [os.getcwd(), WRITTEN_TO]:
        if os.path.exists(os.path.join(folder, "terrain.vtp")):
            return folder
    raise RuntimeError("run.py: terrain.vtp is not found; set WRITTEN_TO in run.py to the folder that it is in")


def show(view, name):
    """None where the run has no such file."""
    path = os.path.join(FOLDER, name)
    if not os.path.exists(path):
        return None, None
    reader = OpenDataFile(path)
    RenameSource(os.path.splitext(name)[0], reader)
    display = Show(reader, view)
    display.Representation = "Surface"
    return reader, display


def colour_by_speed(view, display):
    """One range of colours for the whole run, whatever frame is shown."""
    ColorBy(display, ("POINTS", "speed_mps"))
    speeds = GetColorTransferFunction("speed_mps")
    speeds.AutomaticRescaleRangeMode = "Never"
    speeds.ApplyPreset("Viridis (matplotlib)", True)
    speeds.RescaleTransferFunction(0.0, GREATEST_SPEED)
    bar = GetScalarBar(speeds, view)
    bar.Title, bar.ComponentTitle = "speed, m/s", ""
    bar.LabelFormat, bar.RangeLabelFormat = "%.0f", "%.3g"


FOLDER = folder_of_this_file()
view = GetActiveViewOrCreate("RenderView")
animation = GetAnimationScene()
ground, display = show(view, "terrain.vtp")
display.AmbientColor = display.DiffuseColor = GROUND
structures, display = show(view, "structures.vtp")
if structures:
    ColorBy(display, ("CELLS", "colour"))
    display.MapScalars = 0
surface, surface_display = show(view, "surface.pvd")
particles, display = show(view, "particles.pvd")
animation.UpdateAnimationUsingDataTimeSteps()
animation.GoToLast()
colour_by_speed(view, surface_display)
surface_display.SetScalarBarVisibility(view, True)
if particles:
    display.PointSize = 4.0
    colour_by_speed(view, display)
    Hide(particles, view)  # they lie within the surface: show one or the other

time = AnnotateTimeFilter(surface)
time.Format = "{time:.1f} s"
Show(time, view)
view.CameraViewUp = [0.0, 0.0, 1.0]
view.CameraFocalPoint = [0.0, 0.0, 0.0]
view.CameraPosition = [DOWNHILL[0], DOWNHILL[1], 0.8]
view.ResetCamera()
SetActiveSource(surface)
Render()
