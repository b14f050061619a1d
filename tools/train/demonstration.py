#!/usr/bin/env python3
"""Trains a network that is shipped, of the demonstration or of the paper's experiments: draws rigs, patients and motions, records the loop on them in virtual time,
fits and seals the network, and scores it in the loop, on drawn rigs that it was not trained on and in the configurations that run it.

  tools/train/demonstration.py --out DIR [--leg adult|paper] [--seed 1] [--bin build/release] [--without attention|recurrence]
  tools/train/demonstration.py --out DIR --weights FILE        only the scores, of weights that there are

Leaves demonstration.safetensors, or paper.safetensors, and its card with the ending md in DIR. The same seed gives the same recordings and, on
the same kind of processor with the same libtorch, the same weights to the byte. What was drawn stays in DIR/config: for
each recording what the rig really is, its motion, and the configuration with patient, EMG and sensors.
"""
import argparse
import csv
import hashlib
import math
import pathlib
import random
import shutil
import statistics
import subprocess
import sys
import typing

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONFIG = ROOT / "firmware_app/config"
RECORDINGS = {"training": 60, "validation": 12, "test": 12}
DURATION_S = 12
# A window of one step is no attention. Without recurrence the linear path is left, since the rest learns nothing.
WITHOUT = {"attention": {"window": 1}, "recurrence": {"window": 1, "hidden": 4, "epochs": 1, "learning-rate": 1e-9}}


class Leg(typing.NamedTuple):
    weights: str      # name of the file
    base: str         # configuration of the loop, from which those of the recordings are made
    model: str        # the loop's, from which those of the rigs are made
    scored: tuple     # configurations that run the network
    torque: float     # size of friction, stiffness and bias, 1 for the adult's leg
    push_N: tuple     # least and largest rms
    load_kg: tuple    # payload at the shank
    load_m: tuple     # and its distance from the knee


LEGS = {"adult": Leg("demonstration", "adult.toml", "models/adult.toml", ("adult.toml",), 1.0, (1.0, 14.0), (0.2, 1.5), (0.1, 0.38)),
        "paper": Leg("paper", "paper_experiment_1.toml", "models/physical.toml", ("paper_experiment_1.toml", "paper_experiment_2.toml"),
                     0.04, (0.3, 3.0), (0.02, 0.15), (0.05, 0.24))}
STOPPED = 3  # exit status of a run that ended in a latched stop
SCORED_SEEDS = (11, 12, 13)
DENSITIES = (0.1, 0.3, 1, 3, 10, 30, 100, 300, 1000)  # of the Kalman filter that the network is held against
# Recordings have seeds of their own, far from those of the demonstration. Those of the test were not looked at while features
# and options were chosen.
FIRST_SEED = 100_000
STREAMS = {"training": 1, "validation": 2, "test": 7}

JOINT_LIMITS_RAD = ((-2.05, 0.05), (-2.05, -0.05))  # within the soft limits of the configuration
PEAK_VELOCITY_RAD_S = (2.2, 3.2)

FEATURES = [name.format(joint) for name in ("q{}_rad", "dq{}_rad_s", "tau{}_Nm", "d_hat{}_Nm", "f_s{}_rad_s2", "f_s_filtered{}_rad_s2",
                                            "d_rise_20ms{}_Nm", "d_rise_60ms{}_Nm", "d_rise_180ms{}_Nm") for joint in (1, 2)]
# What patella-train fit is told. At 1 kHz, so that the network takes its step in every tick.
FIT = {"rate-Hz": 1000, "features": ",".join(FEATURES), "output": "torque_correction", "target": "truth", "hidden": 32,
       "channels": 16, "heads": 4, "window": 48, "linear-lags": "0,1,2,3,4,6,8,11,15,20,27,36,48,64", "linear-loss": "absolute",
       "loss": "absolute", "sequence-steps": 320, "burn-in": 96, "batch": 16, "learning-rate": 5e-3, "epochs": 24, "patience": 24,
       "threads": 1}


def replaced(text, table, key, value):
    """The configuration with another value of one key, which must be there."""
    lines, inside, found = text.splitlines(), table == "", 0
    for i, line in enumerate(lines):
        if line.startswith("["):
            inside = line.strip() == f"[{table}]"
        elif inside and line.split("=")[0].strip() == key:
            lines[i] = f"{key} = {value}"
            found += 1
    if found != 1:
        sys.exit(f"key '{key}' of table '{table}' stands there {found} times, expected once")
    return "\n".join(lines) + "\n"


def copied_configuration(folder):
    """The configuration as the loop has it, but without a network; relative paths stay as they are."""
    shutil.copytree(CONFIG, folder, ignore=shutil.ignore_patterns("weights"))
    bus_map = folder / "can/patella.toml"
    shutil.copy(ROOT / "drivers/can/patella.dbc", folder / "can")
    bus_map.write_text(bus_map.read_text().replace("../../../drivers/can/patella.dbc", "patella.dbc"))
    for file in folder.glob("*.toml"):
        file.write_text("".join(line for line in file.read_text().splitlines(True) if not line.startswith("weights =")))


def effect(kind, joint, **parameters):
    lines = [f'\n[[effect]]\nkind = "{kind}"\njoint = {joint}']
    return "\n".join(lines + [f"{name} = {value:.6g}" for name, value in parameters.items()]) + "\n"


def drawn_rig(draw, leg, nominal):
    """A leg whose masses the loop has wrong, in a rig that rubs, is stiff, loaded or biased as the loop is not told."""
    between = draw.uniform
    text = nominal.split("[[effect]]")[0].split("# tau")[0]
    lines = []
    shares = [1 + between(-0.08, 0.08), 1 + between(-0.08, 0.08)]
    for line in text.splitlines():
        name = line.split("=")[0].strip()
        if name in ("mass_kg", "inertia_kg_m2"):
            values = [float(v) for v in line.split("[")[1].split("]")[0].split(",")]
            line = f"{name} = [{', '.join(f'{v * s:.9g}' for v, s in zip(values, shares))}]"
        lines.append(line)
    text = "\n".join(lines) + "\n"
    for joint in (1, 2):
        size = leg.torque
        scale = size * (1.6 if joint == 1 else 1.0)  # the hip carries more
        text += effect("viscous_friction", joint, coefficient_Nms_rad=size * between(0.2, 1.2))
        smoothing = math.exp(between(math.log(0.008), math.log(0.05)))
        dry = draw.random()
        if dry < 0.55:
            text += effect("coulomb_friction", joint, level_Nm=scale * between(0.3, 3.0), smoothing_velocity_rad_s=smoothing)
        elif dry < 0.75:
            text += effect("stribeck_friction", joint, level_Nm=scale * between(0.3, 2.0), stribeck_level_Nm=scale * between(0.1, 1.0),
                           stribeck_velocity_rad_s=between(0.03, 0.2), smoothing_velocity_rad_s=smoothing)
        if draw.random() < 0.6:
            text += effect("linear_stiffness", joint, stiffness_Nm_rad=size * between(0.5, 9.0), rest_position_rad=between(-1.3, -0.1))
        if draw.random() < 0.2:
            text += effect("torque_bias", joint, bias_Nm=size * between(-0.8, 0.8))
        if draw.random() < 0.15:
            text += effect("torque_gain", joint, gain_error=between(-0.05, 0.05))
    if draw.random() < 0.25:
        text += effect("payload", 2, mass_kg=between(*leg.load_kg), distance_m=between(*leg.load_m))
    return text


def drawn_motion(draw):
    """One to five tones a joint, within the joints' range and a share of the permitted velocity."""
    text = "blend_s = 2.0\n"
    for (low, high), peak_rad_s in zip(JOINT_LIMITS_RAD, PEAK_VELOCITY_RAD_S):
        tones = draw.choice((1, 1, 2, 3, 5))
        frequencies = sorted(draw.uniform(0.15, 1.4) for _ in range(tones))
        weights = [draw.uniform(0.3, 1.0) / (0.4 + f) for f in frequencies]
        reach = draw.uniform(0.15, 0.6)
        fastest = sum(2 * math.pi * f * w for f, w in zip(frequencies, weights)) / sum(weights)
        reach = min(reach, draw.uniform(0.5, 1.0) * peak_rad_s / fastest)
        amplitudes = [reach * w / sum(weights) for w in weights]
        offset = draw.uniform(max(low + reach, -1.6), min(high - reach, -0.4))
        text += f'\n[[joint]]\noffset_rad = {offset:.4f}\n'
        if tones == 1:
            text += f'motion = "sinusoid"\nfrequency_Hz = {frequencies[0]:.4f}\namplitude_rad = {amplitudes[0]:.4f}\n'
            text += f"phase_rad = {draw.uniform(0, 6.28):.3f}\n"
        else:
            text += f'motion = "multisine"\nfrequency_Hz = [{", ".join(f"{f:.4f}" for f in frequencies)}]\n'
            text += f'amplitude_rad = [{", ".join(f"{a:.4f}" for a in amplitudes)}]\n'
    return text


def drawn_configuration(draw, leg, base):
    """Patient, EMG, gains and sensors, in a copy of the loop's configuration."""
    text = replaced(base.replace('kind = "experiment_1"', 'kind = "human"\nhuman_rms_N = 1\nhuman_bandwidth_Hz = 1'),
                    "rig.interaction", "human_rms_N", f"{draw.uniform(*leg.push_N):.3f}")
    text = replaced(text, "rig.interaction", "human_bandwidth_Hz", f"{draw.uniform(0.6, 2.5):.3f}")
    text = replaced(text, "rig.encoder", "velocity_noise_sd_rad_s", f"{draw.uniform(0.00035, 0.0007):.6f}")
    text = replaced(text, "rig.encoder", "bits_per_turn", draw.choice((16, 17, 18)))
    text = replaced(text, "rig.emg", "pattern", draw.choice(('"movement"', '"scheduled"')))
    text = replaced(text, "control", "emg", f"{draw.uniform(0.0, 0.5):.3f}")
    text = replaced(text, "control", "compensation", f"{draw.uniform(0.5, 0.9):.3f}")
    return text


def run(command, log):
    with open(log, "w", encoding="utf-8") as out:
        return subprocess.run(command, stdout=out, stderr=subprocess.STDOUT, check=False).returncode


def loop(arguments, stem, config, seed, *options):
    """A run of the loop in virtual time: its status and its folder."""
    folder = arguments.out / "runs" / stem
    log = arguments.out / f"{stem}.txt"
    status = run([arguments.bin / "firmware_app/patella", "run", "--config", config, "--clock", "virtual", "--duration",
                  str(DURATION_S), "--seed", str(seed), "--out", folder, *options], log)
    if status not in (0, STOPPED):
        sys.exit(f"{stem}: {log.read_text()}")
    return status, folder


def record(arguments, config, name, count, seed):
    """COUNT recordings. One in which the loop stopped itself is left out, and another is drawn in its place."""
    drawn = []
    leg = LEGS[arguments.leg]
    nominal, base = (config.parent / leg.model).read_text(), config.read_text()
    while len(drawn) < count:
        draw = random.Random(seed)
        stem = f"{name}-{seed}"
        files = {key: config.parent / f"{stem}.{key}.toml" for key in ("run", "rig", "motion")}
        files["run"].write_text(drawn_configuration(draw, leg, base))
        files["rig"].write_text(drawn_rig(draw, leg, nominal))
        files["motion"].write_text(drawn_motion(draw))
        options = ["--rig-model", files["rig"], "--reference", files["motion"]]
        status, folder = loop(arguments, stem, files["run"], seed, *options)
        if status == 0:
            drawn.append({"folder": folder, "config": files["run"], "seed": seed, "options": options})
        else:
            print(f"  {stem}: the loop stopped itself, another one is drawn", flush=True)
        seed += 1
    return drawn


def mean_errors(folder):
    """Mean |f_u - estimate| of both joints, rad/s^2, of the whole run, by estimate."""
    sums = {estimate: [0.0, 0.0] for estimate in ("f_s", "f_s_filtered", "f_network")}
    count = 0
    with open(folder / "ticks.csv", newline="", encoding="utf-8") as table:
        for row in csv.DictReader(table):
            count += 1
            for estimate, of_joint in sums.items():
                for joint in (0, 1):
                    unit = f"{joint + 1}_rad_s2"
                    if row[estimate + unit] and row["f_true" + unit]:
                        of_joint[joint] += abs(float(row[estimate + unit]) - float(row["f_true" + unit]))
    return {estimate: [value / count for value in of_joint] for estimate, of_joint in sums.items()}


def with_kalman(config, density):
    """The configuration with a Kalman filter of constant rate in the sampler's place, told the sensors' noise."""
    lines = []
    for line in config.read_text().splitlines():
        key = line.split("=")[0].strip()
        if key == "observer":
            lines += ['observer = "kalman_torque"', 'disturbance = "constant_rate"', "position_noise_rad = 2e-5",
                      "velocity_noise_rad_s = 0.0005", "torque_noise_Nm = 0.001",
                      f"disturbance_density = [{density}, {density}]", "disturbance_limit = 1000"]
        elif key not in ("k_d_1_s", "delta_rad_s2", "epsilon", "estimate_cutoff_Hz"):
            lines.append(line)
    file = config.with_name(f"{config.stem}.kalman-{density}.toml")
    file.write_text("\n".join(lines) + "\n")
    return file


def kalman_errors(arguments, drawn, density):
    results = []
    for one in drawn:
        _, folder = loop(arguments, f"kalman-{density}-{one['folder'].name}", with_kalman(one["config"], density), one["seed"],
                         *one["options"])
        results.append(mean_errors(folder)["f_s"])
        shutil.rmtree(folder)
    return results


def network_errors(arguments, drawn, weights):
    results = []
    for one in drawn:
        _, folder = loop(arguments, f"network-{one['folder'].name}", one["config"], one["seed"], "--weights", weights, *one["options"])
        results.append(mean_errors(folder))
    return results


def interval(values):
    """Mean and half of the 95 % interval of Student's t."""
    t = {2: 12.71, 3: 4.303, 12: 2.201}[len(values)]
    return statistics.mean(values), t * statistics.stdev(values) / math.sqrt(len(values))


def table_of(kalman, network):
    rows = {"sampler": [r["f_s"] for r in network], "sampler, filtered": [r["f_s_filtered"] for r in network],
            "Kalman filter": kalman, "network": [r["f_network"] for r in network]}
    lines = ["| mean absolute error of f_u, rad/s² | joint 1 | joint 2 |", "|---|---|---|"]
    for name, errors in rows.items():
        lines.append("| " + " | ".join([name] + ["{:.4f} ± {:.4f}".format(*interval([e[j] for e in errors])) for j in (0, 1)]) + " |")
    for name in ("sampler", "sampler, filtered", "Kalman filter"):
        ratios = [[a[j] / b[j] for a, b in zip(rows["network"], rows[name])] for j in (0, 1)]
        lines.append("| " + " | ".join([f"network to {name}"] + ["{:.2f} ± {:.2f}".format(*interval(r)) for r in ratios]) + " |")
    return "\n".join(lines)


def score(arguments, config, data, weights):
    """Errors in the loop: on the drawn test, and in the configurations that run the network."""
    density = min(DENSITIES, key=lambda q: sum(map(sum, kalman_errors(arguments, data["validation"], q))))
    text = ""
    parts = [(f"{RECORDINGS['test']} drawn rigs, motions and patients that it was not trained on", data["test"])]
    for name in LEGS[arguments.leg].scored:
        parts.append((f"`firmware_app/config/{name}`, seeds {', '.join(map(str, SCORED_SEEDS))}",
                      [{"folder": pathlib.Path(f"{pathlib.Path(name).stem}-{seed}"), "config": config.with_name(name), "seed": seed,
                        "options": []} for seed in SCORED_SEEDS]))
    for title, drawn in parts:
        text += f"\n### {title}\n\n" + table_of(kalman_errors(arguments, drawn, density), network_errors(arguments, drawn, weights)) + "\n"
    text += f"\nThe Kalman filter (`kalman_torque`, constant rate) has the density of {DENSITIES} that errs least in validation: {density}.\n"
    return text


def card(arguments, weights, scores):
    template = (pathlib.Path(__file__).with_name("demonstration_card.md.in")).read_text()
    leg = LEGS[arguments.leg]
    values = {"leg": arguments.leg, "name": leg.weights, "model": leg.model,
              "configurations": " and ".join(f"`firmware_app/config/{name}`" for name in leg.scored), "push": "{} to {}".format(*leg.push_N), "seed": arguments.seed, "size": weights.stat().st_size, "sha256": hashlib.sha256(weights.read_bytes()).hexdigest(),
              "training": RECORDINGS["training"], "validation": RECORDINGS["validation"], "test": RECORDINGS["test"],
              "duration": DURATION_S, "features": ", ".join(f"`{name}`" for name in FEATURES),
              "options": " ".join(f"--{name} {value}" for name, value in FIT.items() if name != "features"), "scores": scores}
    for name, value in values.items():
        template = template.replace("{" + name + "}", str(value))
    return template


def train(arguments, config, data, weights, **changed):
    folders = {name: [one["folder"] for one in drawn] for name, drawn in data.items()}
    options = [part for name, value in (FIT | changed).items() for part in (f"--{name}", str(value))]
    subprocess.run([arguments.bin / "tools/train/patella-train", "fit", "--config", config, "--out", weights, "--seed",
                    str(arguments.seed), *options, "--data", *folders["training"], "--validation-data", *folders["validation"],
                    "--test-data", *folders["test"]], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder for recordings and results; must not exist")
    parser.add_argument("--leg", choices=LEGS, default="adult", help="the demonstration's, or that of the paper's experiments")
    parser.add_argument("--seed", type=int, default=1, help="of all that is drawn")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release", help="folder of the build")
    parser.add_argument("--without", choices=WITHOUT, help="leave out a part of the network, to tell what it is worth")
    parser.add_argument("--weights", type=pathlib.Path, help="score these, train none")
    arguments = parser.parse_args()
    (arguments.out / "runs").mkdir(parents=True)
    leg = LEGS[arguments.leg]
    copied_configuration(arguments.out / "config")
    config = arguments.out / "config" / leg.base
    data = {}
    for name, count in RECORDINGS.items():
        if name == "training" and arguments.weights:
            continue
        print(f"== {count} recordings of {DURATION_S} s for {name}", flush=True)
        data[name] = record(arguments, config, name, count, FIRST_SEED * (100 * arguments.seed + STREAMS[name]))
    weights = arguments.weights or arguments.out / f"{leg.weights}.safetensors"
    if not arguments.weights:
        print("== training", flush=True)
        train(arguments, config, data, weights, **WITHOUT.get(arguments.without, {}))
    print("== in the loop", flush=True)
    scores = score(arguments, config, data, weights)
    print(scores)
    (arguments.out / f"{leg.weights}.md").write_text(card(arguments, weights, scores))


if __name__ == "__main__":
    main()
