"""`asterism materials`: the measured materials."""

from __future__ import annotations

from asterism.cli.common.run import DONE, WRONG_INPUT, Run, command


@command
def materials(run: Run) -> int:
    """List measured materials, which all commands take by name, and the folders of your own.

    The exit status is 2 if one of your files is wrong; the list contains the others.
    """
    from asterism.laws.replace_material import material_in_words
    from asterism.pattern.design.errors import DesignError
    from asterism.pattern.design.files import PROFILES_VARIABLE, own_folders
    from asterism.pattern.design.material_files import MATERIALS_FOLDER, material_files

    wrong = []
    for name, path in material_files().items():
        try:
            run.table({name: material_in_words(path)}, width=14)
        except DesignError as error:
            wrong.append(str(error))
    own = " or ".join(str(folder / MATERIALS_FOLDER) for folder in own_folders())
    run.lines([f"yours: NAME.toml in {own} ({PROFILES_VARIABLE}); asterism strips fit --save NAME writes one"])
    run.warn(*wrong)
    return WRONG_INPUT if wrong else DONE
