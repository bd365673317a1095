"""``crosscontact scenes``: the built-in scenes."""

from validation import scenes


def run() -> int:
    """Name, quick suite or not, and title of every built-in scene."""
    titles = scenes.titles()
    width = max(map(len, titles))
    quick = set(scenes.suite("quick"))
    for name, title in titles.items():
        print(f"{name:<{width}}  {'quick' if name in quick else '     '}  {title}")
    return 0
