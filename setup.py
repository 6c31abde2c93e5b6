"""Where the packages are: the engines stand beside `asterism` in the checkout, and are installed inside it."""

from setuptools import find_packages, setup

ENGINES = ("discrete", "equilibrium", "fem", "homogenize", "pattern")

inside = [package for engine in ENGINES for package in find_packages(include=[engine, f"{engine}.*"])]
setup(
    packages=[*find_packages(include=["asterism", "asterism.*"]), *(f"asterism.{package}" for package in inside)],
    package_dir={f"asterism.{engine}": engine for engine in ENGINES},
)
