"""The law of stars: how far an endless sheet contracts and curls.

Picture: law.svg
"""

import numpy as np

import asterism

table = asterism.load_law().at(1.35)  # for fabric that is stretched by 1.35
lengths = np.array([4.0, 6.0, 8.0, 10.0])
values = table(lengths, 0.3, 1.2).value  # 0.3 mm thick, 1.2 mm wide
print("contraction", values["lam_n"].round(3))
print("radius of the endless tube, mm", (1 / values["kappa"]).round(1))
