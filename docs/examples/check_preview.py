"""How good is a preview? Its distance from the exact shape, and its own estimate.

Picture: verified.png
"""

import asterism

data = asterism.new("dome").to_dict()
data["border"] = {"rings": 2}
found = asterism.verify(asterism.Design.from_dict(data))
print(f"{found.summary['rms_percent']:.2f} % away, estimated {found.summary['expected_rms_percent']:.2f} %")
asterism.write_verification(found, "dome-verified")
