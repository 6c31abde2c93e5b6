"""From a surface to a design: stars for a shallow vault.

Picture: fit-ellipsoid-dome.webp
"""

import asterism

target = asterism.TargetSurface.of_formula("10*(1 - (r/50)**2)", 80.0, name="vault")
fitted = asterism.fit(target, asterism.FitSettings(exact=False))
print(f"{fitted.summary.preview.mean_percent:.2f} % of the diameter away")
asterism.save_design(fitted.design, "vault.toml")
