# Runs the script in docs/network.md and writes, beside its weights, features and what PyTorch makes of them.
#   reference.py NETWORK_MD FOLDER
import os
import re
import sys

with open(sys.argv[1]) as file:
    script = re.search(r"```python\n(.*?)```", file.read(), re.DOTALL).group(1)
os.chdir(sys.argv[2])
names = {}
exec(compile(script, sys.argv[1], "exec"), names)
torch, metadata = names["torch"], names["metadata"]


def row(key):
    return torch.tensor([float(number) for number in metadata[key].split(",")], dtype=torch.float64)


torch.manual_seed(7)
model = names["model"].double()
normalised = torch.randn(1, 2000, len(row("feature_mean")), dtype=torch.float64)
with torch.no_grad():
    outputs = model(normalised)[0] * row("output_scale") + row("output_mean")
features = normalised[0] * row("feature_scale") + row("feature_mean")
with open("reference.csv", "w") as file:
    inputs = features.shape[1]
    file.write(",".join([f"x{i}" for i in range(inputs)] + [f"y{i}" for i in range(outputs.shape[1])]) + "\n")
    for step in torch.cat([features, outputs], 1).tolist():
        file.write(",".join(repr(number) for number in step) + "\n")
