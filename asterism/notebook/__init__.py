"""The sheet in a notebook: the studio's view as a widget, and sliders for a preview.

Only `widget` imports anywidget, which the extra `notebook` installs.
"""
