// Fault scripts with one defect each.
#include <doctest/doctest.h>

#include "tests/integration/malformed/patella_process.hpp"

using namespace patella::test;

namespace {

const char* const kScript = "faults.toml";

Case script(const char* defect, const std::string& text, std::vector<std::string> says) {
  return {defect, written(kScript, text), std::move(says), {"--faults", std::string("{dir}") + kScript}};
}

}  // namespace

TEST_CASE("a fault script that cannot be acted out") {
  expectRunRefused({
      {"missing", none(), {"faults.toml: cannot be opened"}, {"--faults", "{dir}faults.toml"}},
      script("empty", "", {"faults.toml: holds no fault"}),
      script("syntax", "[[fault]\n", {"faults.toml:1:"}),
      script("no kind", "[[fault]]\ntime_s = 1\n", {"faults.toml:1: key 'fault[1].kind'"}),
      script("unknown kind", "[[fault]]\nkind = \"lost_frame\"\ntime_s = 1\n",
             {"faults.toml:2: key 'fault[1].kind': value 'lost_frame'", "lost_frames"}),
      script("no time", "[[fault]]\nkind = \"bus_off\"\n", {"faults.toml:1: key 'fault[1].time_s'"}),
      script("before the start", "[[fault]]\nkind = \"bus_off\"\ntime_s = -1\n",
             {"faults.toml:3: key 'fault[1].time_s': value -1, expected a number in [0, 2592000]"}),
      script("lasts no time", "[[fault]]\nkind = \"bus_off\"\ntime_s = 1\nduration_s = 0\n",
             {"faults.toml:4: key 'fault[1].duration_s': value 0"}),
      script("stall without an end", "[[fault]]\nkind = \"loop_stall\"\ntime_s = 1\n",
             {"faults.toml:1: key 'fault[1].duration_s'"}),
      script("channel of another kind",
             "[[fault]]\nkind = \"lost_frames\"\ntime_s = 1\nchannel = \"drive1\"\n",
             {"faults.toml:4: key 'fault[1].channel': value 'drive1'", "command"}),
      script("channel where there is none", "[[fault]]\nkind = \"bus_off\"\ntime_s = 1\nchannel = \"emg\"\n",
             {"faults.toml:4: key 'fault[1].channel' is unknown"}),
      script("impossible probability", "[[fault]]\nkind = \"lost_frames\"\ntime_s = 1\nprobability = 1.5\n",
             {"faults.toml:4: key 'fault[1].probability': value 1.5, expected a number in [1e-06, 1]"}),
      script("parameter of another kind",
             "[[fault]]\nkind = \"encoder_jump\"\ntime_s = 1\noffset_rad = 0.1\nrate_rad_s = 1\n",
             {"faults.toml:5: key 'fault[1].rate_rad_s' is unknown"}),
      script("no size", "[[fault]]\nkind = \"encoder_jump\"\ntime_s = 1\n",
             {"faults.toml:1: key 'fault[1].offset_rad'"}),
      script("second of two",
             "[[fault]]\nkind = \"bus_off\"\ntime_s = 1\n\n[[fault]]\nkind = \"emg_hum\"\n"
             "time_s = 1\namplitude_mV = 0.1\nfrequency_Hz = 400\n",
             {"faults.toml:9: key 'fault[2].frequency_Hz': value 400, expected a number in [45, 65]"}),
      {"fault of a rig that is elsewhere",
       written(kScript, "[[fault]]\nkind = \"encoder_drift\"\ntime_s = 1\nrate_rad_s = 1\n"),
       {"faults.toml:2: key 'fault[1].kind': value 'encoder_drift', expected a fault of the loop's host",
        "patella-rig --faults"},
       {"--faults", "{dir}faults.toml", "--backend", "can:can0"}},
  });
}
