"""The commands of many runs, which write a report of them."""

WORK = {
    "compare SCENE": "compare.compare_scenes",
    "study SCENE": "study.study",
    "study SCENE --poisson 10": "study.Poisson.runs",
    "study SCENE --zones 0.01": "study.Zones.runs",
    "stability": "stability.compute",
    "report": "report.compare_scenes",
}
"""The function, in ``crosscontact.commands``, that does the work of each."""
