"""The studio: a page on the designer's machine on which she draws stars and sees the sheet rise.

`server` answers the browser and `engine` computes, each in a process of its own. `studio` connects both with the
document.
"""
