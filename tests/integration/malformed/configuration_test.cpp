// Run configurations with one defect each.
#include <doctest/doctest.h>

#include "tests/integration/malformed/patella_process.hpp"

using namespace patella::test;

TEST_CASE("the shipped configuration itself is sound, so that every refusal below is owed to its defect") {
  const Workshop workshop;
  const Outcome check = workshop.patella({"check", "--config", workshop.file(kConfig).string()});
  INFO(check.errors);
  CHECK(check.exit_status == 0);
  const Outcome run =
      workshop.patella({"run", "--clock", "virtual", "--duration", "0.1", "--config",
                        workshop.file(kConfig).string(), "--out", workshop.output().string()});
  INFO(run.errors);
  CHECK(run.exit_status == 0);
  CHECK(run.errors.empty());
  for (const char* name : {"out/frames.log", "out/ticks.csv", "out/events.log", "out/summary.json"}) {
    CHECK(workshop.listing().contains(name));
  }
}

TEST_CASE("a configuration that is no TOML, or not there") {
  expectRefused({
      {"syntax error", replaced(kConfig, "rate_Hz = 1000", "rate_Hz = = 1000"), {"adult.toml:{line}:"}, {}},
      {"key twice",
       replaced(kConfig, "rate_Hz = 1000", "rate_Hz = 1000\nrate_Hz = 500"),
       {"adult.toml:", "rate_Hz"},
       {}},
      {"empty", written(kConfig, ""), {"adult.toml:1:", "key 'bus' is missing"}, {}},
      {"binary",
       written(kConfig, std::string("\x7f"
                                    "ELF\0\1\2\xff",
                                    8)),
       {"adult.toml:1:"},
       {}},
      {"missing", removed(kConfig), {"adult.toml: cannot be opened: No such file"}, {}},
      {"folder", turnedIntoFolder(kConfig), {"adult.toml: is a directory, expected a regular file"}, {}},
  });
}

TEST_CASE("files that are no files, or have no end, are refused at once and by name") {
  const std::string deep(100'000, '[');
  std::string dotted = "a";
  for (int i = 0; i < 100'000; ++i)
    dotted += ".a";
  std::string items;
  for (int i = 0; i < 400'000; ++i)
    items += "1,";
  expectRefused({
      {"zeroes",
       linkedTo(kConfig, "/dev/zero"),
       {"adult.toml: is a character device, expected a regular"},
       {}},
      {"chance",
       linkedTo(kModel, "/dev/urandom"),
       {"adult.toml: is a character device, expected a regular"},
       {}},
      {"pipe", turnedIntoPipe(kMap), {"patella.toml: is a pipe, expected a regular file"}, {}},
      {"zeroes for a DBC", linkedTo(kDbc, "/dev/zero"), {"patella.dbc: is a character device"}, {}},
      {"megabytes",
       written(kConfig, std::string(1'000'001, '\n')),
       {"adult.toml: is 1000001 bytes long, expected at most 1000000 of a configuration"},
       {}},
      {"nested arrays",
       written(kConfig, "x = " + deep),
       {"adult.toml:1: more than 16 brackets within brackets, expected at most 16"},
       {}},
      {"dotted key of a model",
       written(kModel, dotted + " = 1"),
       {"models/adult.toml:1: more than 16 parts of a dotted key, expected at most 16"},
       {}},
      {"elements",
       written(kConfig, "x = [" + items + "]"),
       {"adult.toml:1: more than 20000 keys and elements, expected at most 20000"},
       {}},
      {"weights that are a device",
       none(),
       {"/dev/zero: is a character device, expected a regular file"},
       {"--weights", "/dev/zero"}},
  });
  expectRunRefused({
      {"a log that is a device",
       none(),
       {"/dev/zero: is a character device, expected a regular file"},
       {"--backend", "replay:/dev/zero"}},
      {"a log of one line",
       written("run.log", std::string(5'000'000, '(')),
       {"run.log:1: the line is too long, expected at most 1024 bytes"},
       {"--backend", "replay:{dir}run.log"}},
  });
}

TEST_CASE("a configuration with a key that nobody knows, or without one that is needed") {
  expectRefused({
      {"misspelt key",
       replaced(kConfig, "duration_s = 12", "duraton_s = 12"),
       {"adult.toml:{line}:", "'loop.duraton_s' is unknown", "did you mean 'duration_s'"},
       {}},
      {"forgotten unit",
       replaced(kConfig, "healthy_ticks = 50", "blend = 2"),
       {"adult.toml:{line}:", "'safety.blend' is unknown"},
       {}},
      {"misspelt section",
       replaced(kConfig, "[estimation]", "[estimaton]"),
       {"adult.toml:{line}:", "'estimaton' is unknown", "did you mean 'estimation'"},
       {}},
      {"no safety limits",
       replaced(kConfig, "torque_rate_Nm_s = [2000, 2000]\n", ""),
       {"adult.toml:", "'safety.torque_rate_Nm_s' is missing", "expected an array of 2 finite numbers"},
       {}},
      {"no bus map",
       replaced(kConfig, "map = \"can/patella.toml\"", ""),
       {"adult.toml:", "'bus.map' is missing"},
       {}},
      {"no model",
       replaced(kConfig, "model = \"models/adult.toml\"", ""),
       {"adult.toml:", "'model' is missing"},
       {}},
  });
}

TEST_CASE("a value of another type") {
  expectRefused({
      {"text for a number",
       replaced(kConfig, "rate_Hz = 1000", "rate_Hz = \"fast\""),
       {"adult.toml:{line}: key 'loop.rate_Hz': value 'fast'", "expected a number in [50, 20000]"},
       {}},
      {"number for a boolean",
       replaced(kConfig, "lock_memory = true", "lock_memory = 1"),
       {"adult.toml:{line}: key 'realtime.lock_memory': value 1, expected true or false"},
       {}},
      {"number for an array",
       replaced(kConfig, "torque_Nm = [120, 80]", "torque_Nm = 120"),
       {"adult.toml:{line}: key 'safety.torque_Nm': value 120, expected an array of 2"},
       {}},
      {"table for a value",
       replaced(kConfig, "seed = 1", "seed = { value = 1 }"),
       {"adult.toml:{line}: key 'rig.seed': value a table, expected an integer"},
       {}},
      {"value for a table",
       replaced(kConfig, "[reference]\nblend_s = 2.0\n[[reference.joint]]\n", "[[reference]]\n"),
       {"adult.toml:{line}: key 'reference'", "expected a table"},
       {}},
  });
}

TEST_CASE("a number out of its range, in every section") {
  expectRefused({
      {"loop",
       replaced(kConfig, "duration_s = 12", "duration_s = -1"),
       {"adult.toml:{line}: key 'loop.duration_s': value -1, expected a number in [0, "},
       {}},
      {"realtime",
       replaced(kConfig, "priority = 80", "priority = 100"),
       {"adult.toml:{line}: key 'realtime.priority': value 100, expected an integer in [0, 98]"},
       {}},
      {"half a processor",
       replaced(kConfig, "cpus = []", "cpus = [0.5]"),
       {"adult.toml:{line}: key 'realtime.cpus': value 0.5, expected"},
       {}},
      {"bus",
       replaced(kConfig, "map = \"can/patella.toml\"", "bitrate_bit_s = 9000000\nmap = \"can/patella.toml\""),
       {"adult.toml:{line}: key 'bus.bitrate_bit_s': value 9000000, expected an integer in [0, 1000000]"},
       {}},
      {"estimation",
       replaced(kConfig, "k_d_1_s = 300", "k_d_1_s = 0"),
       {"adult.toml:{line}: key 'estimation.k_d_1_s': value 0, expected a number in [0.1, 10000]"},
       {}},
      {"even exponent of the sampler",
       replaced(kConfig, "epsilon = 0.55", "p0 = 2"),
       {"adult.toml", "p0", "2", "odd"},
       {}},
      {"cutoff above half the sample rate",
       replaced(kConfig, "estimate_cutoff_Hz = 25", "estimate_cutoff_Hz = 600"),
       {"adult.toml:{line}: key 'estimation.estimate_cutoff_Hz': value 600, expected less than 500"},
       {}},
      {"emg band turned round",
       replaced(kConfig, "band_low_Hz = 20", "band_low_Hz = 460"),
       {"adult.toml: emg.band_low_Hz = 460, expected 1 to 405"},
       {}},
      {"control",
       replaced(kConfig, "compensation = 0.8", "compensation = 1.5"),
       {"adult.toml:{line}: key 'control.compensation': value 1.5, expected a number in [0, 1]"},
       {}},
      {"negative stiffness",
       replaced(kConfig, "stiffness_Nm_rad = [120, 60]", "stiffness_Nm_rad = [120, -60]"),
       {"adult.toml:{line}: key 'control.stiffness_Nm_rad': value -60, expected"},
       {}},
      {"reference",
       replaced(kConfig, "blend_s = 2.0", "blend_s = 0"),
       {"adult.toml:{line}: key 'reference.blend_s': value 0, expected a number in [0.1, 60]"},
       {}},
      {"torque above the ceiling",
       replaced(kConfig, "torque_Nm = [120, 80]", "torque_Nm = [120, 151]"),
       {"adult.toml:{line}: key 'safety.torque_Nm': value 151, expected", "[0.001, 150]"},
       {}},
      {"joint range turned round",
       replaced(kConfig, "q_max_rad = [0.2, 0.1]", "q_max_rad = [-2.5, 0.1]"),
       {"adult.toml:{line}: key 'safety.q_max_rad': value -2.5 of joint 1, expected more than q_min_rad, "
        "which is "
        "-2.2"},
       {}},
      {"soft margin wider than the range",
       replaced(kConfig, "soft_margin_rad = [0.05, 0.05]", "soft_margin_rad = [0.05, 4]"),
       {"adult.toml", "soft_margin_rad", "4", "expected"},
       {}},
      {"rig",
       replaced(kConfig, "watchdog_s = 0.02", "watchdog_s = 2"),
       {"adult.toml:{line}: key 'rig.drive.watchdog_s': value 2, expected a number in [0.001, 1]"},
       {}},
      {"rig's encoder of three bits",
       replaced(kConfig, "bits_per_turn = 17", "bits_per_turn = 3"),
       {"adult.toml", "bits_per_turn", "3", "expected 0 or 4 to 32"},
       {}},
      {"rig below the loop's rate",
       replaced(kConfig, "rate_Hz = 1000", "rate_Hz = 20"),
       {"adult.toml:{line}: key 'loop.rate_Hz': value 20, expected a number in [50, 20000]"},
       {}},
  });
}

TEST_CASE("a number that is none") {
  expectRefused({
      {"nan",
       replaced(kConfig, "delta_rad_s2 = 60", "delta_rad_s2 = nan"),
       {"adult.toml:{line}: key 'estimation.delta_rad_s2': value nan, expected a number in [0.001, 10000]"},
       {}},
      {"infinity",
       replaced(kConfig, "velocity_rad_s = [4, 6]", "velocity_rad_s = [4, inf]"),
       {"adult.toml:{line}: key 'safety.velocity_rad_s': value inf, expected"},
       {}},
      {"nan where any number is allowed",
       replaced(kConfig, "initial_q_rad = [-1.4, -0.2]", "initial_q_rad = [-1.4, nan]"),
       {"adult.toml:{line}: key 'rig.initial_q_rad': value nan, expected an array of 2 finite numbers"},
       {}},
  });
}

TEST_CASE("another number of joints than the model's") {
  expectRefused({
      {"limits for one joint",
       replaced(kConfig, "torque_Nm = [120, 80]", "torque_Nm = [120]"),
       {"adult.toml:{line}: key 'safety.torque_Nm': 1 elements, expected an array of 2"},
       {}},
      {"gains for three joints",
       replaced(kConfig, "damping_Nms_rad = [12, 6]", "damping_Nms_rad = [12, 6, 3]"),
       {"adult.toml:{line}: key 'control.damping_Nms_rad': 3 elements, expected an array of 2"},
       {}},
      {"motion of one joint",
       replaced(kConfig,
                "offset_rad = -1.15\namplitude_rad = 0.25\nfrequency_Hz = 0.4\n[[reference.joint]]\nmotion = "
                "\"sinusoid\"\n",
                ""),
       {"adult.toml:", "'reference.joint': 1 tables, expected 2"},
       {}},
      {"emg channels",
       replaced(kConfig, "mvc_mV = [0.25, 0.25, 0.25, 0.25]", "mvc_mV = [0.25, 0.25]"),
       {"adult.toml:{line}: key 'emg.mvc_mV': 2 elements, expected an array of 4"},
       {}},
      {"rig with one joint",
       [](Workshop& workshop) {
         workshop.write(kRigModel,
                        "[mechanism]\nkind = \"revolute\"\ninertia_kg_m2 = 0.3\nmoment_kg_m = 1.0\n"
                        "length_m = 0.4\n");
         workshop.replace(kConfig, "model = \"models/adult_rubbing.toml\"",
                          "model = \"models/adult_rubbing.toml\"");
       },
       {"adult.toml:{line}: key 'rig.model'", "a mechanism of 1 joints, expected 2"},
       {}},
  });
}

TEST_CASE("a multisine that does not add up") {
  const auto hip = [](const char* text) {
    return replaced(kConfig,
                    "motion = \"sinusoid\"\noffset_rad = -1.15\namplitude_rad = 0.25\nfrequency_Hz = 0.4\n",
                    text);
  };
  expectRefused({
      {"amplitudes and frequencies of different number",
       hip("motion = \"multisine\"\noffset_rad = -1.15\nfrequency_Hz = [0.4, 0.9]\namplitude_rad = [0.2]\n"),
       {"adult.toml:", ": key 'reference.joint[1].amplitude_rad': 1 elements, expected an array of 2"},
       {}},
      {"no component",
       hip("motion = \"multisine\"\noffset_rad = -1.15\nfrequency_Hz = []\namplitude_rad = []\n"),
       {"adult.toml:", ": key 'reference.joint[1].frequency_Hz': 0 elements"},
       {}},
      {"too fast",
       hip("motion = \"multisine\"\noffset_rad = -1.15\nfrequency_Hz = [0.4, 9]\namplitude_rad = [0.2, "
           "0.1]\n"),
       {"adult.toml:", ": key 'reference.joint[1].frequency_Hz': value 9, expected an array of"},
       {}},
      {"too far",
       hip("motion = \"multisine\"\noffset_rad = -1.15\nfrequency_Hz = [0.4, 0.9]\namplitude_rad = [2, 2]\n"),
       {"adult.toml:", ": key 'reference.joint[1].amplitude_rad': sum 4, expected a sum of 3.14"},
       {}},
      {"a phase of a sinusoid that is none",
       hip("motion = \"multisine\"\noffset_rad = -1.15\nfrequency_Hz = [0.4]\namplitude_rad = [0.2]\n"
           "phases_rad = [0]\n"),
       {"adult.toml:", ": key 'reference.joint[1].phases_rad'", "phase_rad"},
       {}},
  });
}

TEST_CASE("a choice that there is not") {
  expectRefused({
      {"observer",
       replaced(kConfig, "observer = \"implicit_sampler\"", "observer = \"kalman\""),
       {"adult.toml:{line}: key 'estimation.observer': value 'kalman'",
        "expected one of 'implicit_sampler', 'printed_sampler'", "'kalman_force'"},
       {}},
      {"number of the sampler with another observer",
       replaced(kConfig, "observer = \"implicit_sampler\"\nk_d_1_s = 300\ndelta_rad_s2 = 60",
                "observer = \"momentum\"\nbandwidth_Hz = [5, 5]\nk_d_1_s = 300"),
       {"adult.toml:", "'estimation.k_d_1_s' is unknown"},
       {}},
      {"number that an observer cannot do without",
       replaced(kConfig, "observer = \"implicit_sampler\"\nk_d_1_s = 300\ndelta_rad_s2 = 60",
                "observer = \"extended_state\""),
       {"adult.toml:", "key 'estimation.bandwidth_Hz' is missing"},
       {}},
      {"one number for two joints",
       replaced(kConfig, "observer = \"implicit_sampler\"\nk_d_1_s = 300\ndelta_rad_s2 = 60",
                "observer = \"extended_state\"\nbandwidth_Hz = [5]"),
       {"adult.toml:", "key 'estimation.bandwidth_Hz'", "2"},
       {}},
      {"motion",
       replaced(kConfig, "motion = \"sinusoid\"\noffset_rad = -1.15",
                "motion = \"square\"\noffset_rad = -1.15"),
       {"adult.toml:{line}: key 'reference.joint[1].motion': value 'square'",
        "expected one of 'hold', 'sinusoid', 'multisine', 'move'"},
       {}},
      {"backend",
       replaced(kConfig, "backend = \"sim\"", "backend = \"ethercat\""),
       {"adult.toml:{line}: key 'bus.backend': value 'ethercat', expected sim, can:INTERFACE or replay:LOG"},
       {}},
      {"clock",
       replaced(kConfig, "clock = \"monotonic\"", "clock = \"sundial\""),
       {"adult.toml:{line}: key 'loop.clock': value 'sundial', expected one of 'monotonic', 'virtual'"},
       {}},
      {"compensation by a network that is not given",
       [](Workshop& workshop) {
         workshop.replace(kConfig, "weights = ", "# weights = ");
         workshop.replace(kConfig, "compensation_source = \"sampler\"", "compensation_source = \"network\"");
       },
       {"adult.toml:{line}: key 'control.compensation_source': value 'network'", "no weights are given"},
       {}},
      {"interaction of the rig",
       replaced(kConfig, "kind = \"human\"", "kind = \"ghost\""),
       {"adult.toml:{line}: key 'rig.interaction.kind': value 'ghost'", "'experiment_1'"},
       {}},
  });
}
