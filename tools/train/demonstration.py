#!/usr/bin/env python3
"""Trains the network of the demonstration: draws rigs, patients and motions, records the loop on them in virtual time,
fits the network, scores it on drawn recordings that it was not trained on, and seals it.

  tools/train/demonstration.py --out DIR [--seed 1] [--bin build/release] [--weights FILE]

The same seed gives the same recordings and, on the same kind of processor, the same weights to the byte. What is drawn
stands beside every recording: what the rig really is, its motion, and the configuration with patient, EMG and sensors.
"""
import argparse
import math
import pathlib
import random
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONFIG = ROOT / "firmware_app/config"
BASE = "adult.toml"
RECORDINGS = {"training": 60, "validation": 12, "test": 12}
DURATION_S = 12
# Recordings have seeds of their own, far from those of the demonstration, which begin at 1.
FIRST_SEED = 100_000

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
        sys.exit(f"{BASE}: key '{key}' of table '{table}' stands there {found} times, expected once")
    return "\n".join(lines) + "\n"


def copied_configuration(folder):
    """The configuration as the loop has it, but without a network; relative paths stay as they are."""
    shutil.copytree(CONFIG, folder, ignore=shutil.ignore_patterns("weights"))
    bus_map = folder / "can/patella.toml"
    shutil.copy(ROOT / "drivers/can/patella.dbc", folder / "can")
    bus_map.write_text(bus_map.read_text().replace("../../../drivers/can/patella.dbc", "patella.dbc"))
    base = folder / BASE
    base.write_text("".join(line for line in base.read_text().splitlines(True) if not line.startswith("weights =")))
    return base


def effect(kind, joint, **parameters):
    lines = [f'\n[[effect]]\nkind = "{kind}"\njoint = {joint}']
    return "\n".join(lines + [f"{name} = {value:.6g}" for name, value in parameters.items()]) + "\n"


def drawn_rig(draw, nominal):
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
        scale = 1.6 if joint == 1 else 1.0  # the hip carries more
        text += effect("viscous_friction", joint, coefficient_Nms_rad=between(0.2, 1.2))
        smoothing = math.exp(between(math.log(0.008), math.log(0.05)))
        dry = draw.random()
        if dry < 0.55:
            text += effect("coulomb_friction", joint, level_Nm=scale * between(0.3, 3.0), smoothing_velocity_rad_s=smoothing)
        elif dry < 0.75:
            text += effect("stribeck_friction", joint, level_Nm=scale * between(0.3, 2.0), stribeck_level_Nm=scale * between(0.1, 1.0),
                           stribeck_velocity_rad_s=between(0.03, 0.2), smoothing_velocity_rad_s=smoothing)
        if draw.random() < 0.6:
            text += effect("linear_stiffness", joint, stiffness_Nm_rad=between(0.5, 9.0), rest_position_rad=between(-1.3, -0.1))
        if draw.random() < 0.2:
            text += effect("torque_bias", joint, bias_Nm=between(-0.8, 0.8))
        if draw.random() < 0.15:
            text += effect("torque_gain", joint, gain_error=between(-0.05, 0.05))
    if draw.random() < 0.25:
        text += effect("payload", 2, mass_kg=between(0.2, 1.5), distance_m=between(0.1, 0.38))
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


def drawn_configuration(draw, base):
    """Patient, EMG, gains and sensors, in a copy of the loop's configuration."""
    text = replaced(base, "rig.interaction", "human_rms_N", f"{draw.uniform(1.0, 14.0):.3f}")
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


def record(arguments, config, name, count, seed):
    """COUNT recordings of 12 s. One in which the loop stopped itself is left out, and another is drawn in its place."""
    folders = []
    nominal, base = (config.parent / "models/adult.toml").read_text(), config.read_text()
    while len(folders) < count:
        draw = random.Random(seed)
        stem = f"{name}-{seed}"
        files = {key: config.parent / f"{stem}.{key}.toml" for key in ("run", "rig", "motion")}
        files["run"].write_text(drawn_configuration(draw, base))
        files["rig"].write_text(drawn_rig(draw, nominal))
        files["motion"].write_text(drawn_motion(draw))
        folder = arguments.out / "runs" / stem
        command = [arguments.bin / "firmware_app/patella", "run", "--config", files["run"], "--rig-model", files["rig"],
                   "--reference", files["motion"], "--clock", "virtual", "--duration", str(DURATION_S), "--seed", str(seed),
                   "--out", folder]
        log = arguments.out / f"{stem}.txt"
        status = run(command, log)
        if status == 0:
            folders.append(folder)
        elif status == 3:
            print(f"  {stem}: the loop stopped itself, another one is drawn", flush=True)
        else:
            sys.exit(f"{stem}: {log.read_text()}")
        seed += 1
    return folders


def train(arguments, config, data, weights, **changed):
    options = [part for name, value in (FIT | changed).items() for part in (f"--{name}", str(value))]
    subprocess.run([arguments.bin / "tools/train/patella-train", "fit", "--config", config, "--out", weights, "--seed",
                    str(arguments.seed), *options, "--data", *data["training"], "--validation-data", *data["validation"],
                    "--test-data", *data["test"]], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder for recordings and results; must not exist")
    parser.add_argument("--seed", type=int, default=1, help="of all that is drawn")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release", help="folder of the build")
    arguments = parser.parse_args()
    (arguments.out / "runs").mkdir(parents=True)
    config = copied_configuration(arguments.out / "config")
    data = {}
    for i, (name, count) in enumerate(RECORDINGS.items()):
        print(f"== {count} recordings of {DURATION_S} s for {name}", flush=True)
        data[name] = record(arguments, config, name, count, FIRST_SEED * (100 * arguments.seed + i + 1))
    print("== training", flush=True)
    train(arguments, config, data, arguments.out / "demonstration.safetensors")


if __name__ == "__main__":
    main()
