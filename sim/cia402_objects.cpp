#include "sim/cia402_objects.hpp"

#include <cmath>

namespace patella::sim {
namespace {

std::vector<DictionaryObject> pdo(unsigned communication, unsigned mapping, std::uint32_t id,
                                  std::uint32_t object) {
  constexpr std::uint8_t kEntries = 4;
  const auto at = [](unsigned index) { return static_cast<std::uint16_t>(index); };
  std::vector<DictionaryObject> objects = {{at(communication), 0, 1, false, false, 2},
                                           {at(communication), 1, 4, true, false, id},
                                           {at(communication), 2, 1, true, false, 255},
                                           {at(mapping), 0, 1, true, false, 1}};
  for (std::uint8_t entry = 1; entry <= kEntries; ++entry) {
    objects.push_back({at(mapping), entry, 4, true, false, entry == 1 ? object : 0});
  }
  return objects;
}

}  // namespace

std::vector<DictionaryObject> cia402Objects(const FieldDriveOptions& options) {
  const auto node = static_cast<std::uint32_t>(options.id);
  const auto rated =
      static_cast<std::uint32_t>(std::lround(options.rated_torque_Nm / options.rated_torque_unit_Nm));
  // Profile position and velocity, torque, homing, the three cyclic synchronous modes.
  constexpr std::uint32_t kModes = 0x000003AD;
  std::vector<DictionaryObject> objects = {{0x1000, 0, 4, false, false, 0x00020192},
                                           {0x1001, 0, 1, false, true, 0},
                                           {0x1005, 0, 4, true, false, 0x80},
                                           {0x1014, 0, 4, false, false, 0x80 + node},
                                           {0x1016, 0, 1, false, false, 1},
                                           {0x1016, 1, 4, true, false, 0},
                                           {0x1017, 0, 2, true, false, 0},
                                           {0x1018, 0, 1, false, false, 4},
                                           {0x1018, 1, 4, false, false, 0x0000CAFE},
                                           {0x1018, 2, 4, false, false, 0x00000402},
                                           {0x1018, 3, 4, false, false, 0x00010000},
                                           {0x1018, 4, 4, false, false, node},
                                           {0x603F, 0, 2, false, true, 0},
                                           {0x6040, 0, 2, true, true, 0},
                                           {0x6041, 0, 2, false, true, 0x0240},
                                           {0x6060, 0, 1, true, true, 0},
                                           {0x6061, 0, 1, false, true, 0},
                                           {0x6064, 0, 4, false, true, 0},
                                           {0x6071, 0, 2, true, true, 0},
                                           {0x6072, 0, 2, true, true, 1000},
                                           {0x6076, 0, 4, false, false, rated},
                                           {0x6077, 0, 2, false, true, 0},
                                           {0x60C2, 0, 1, false, false, 2},
                                           {0x60C2, 1, 1, true, false, 10},
                                           {0x60C2, 2, 1, true, false, 0xFD},
                                           {0x6502, 0, 4, false, false, kModes}};
  for (const std::vector<DictionaryObject>& more :
       {pdo(0x1400, 0x1600, 0x200 + node, 0x60400010), pdo(0x1401, 0x1601, 0x300 + node, 0x60400010),
        pdo(0x1800, 0x1A00, 0x40000180 + node, 0x60410010),
        pdo(0x1801, 0x1A01, 0x40000280 + node, 0x60410010)}) {
    objects.insert(objects.end(), more.begin(), more.end());
  }
  return objects;
}

}  // namespace patella::sim
