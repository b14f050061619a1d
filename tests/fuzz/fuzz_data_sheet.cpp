// A data sheet is read or refused; what is read has parameters that fit their entries.
#include <cstdlib>

#include "drivers/canopen/data_sheet.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace patella;
  try {
    const canopen::DataSheet sheet = canopen::parseDataSheet(fuzz::text(data, size), "fuzz.eds", 5);
    for (const canopen::ObjectValue& value : canopen::parametersOf(sheet)) {
      if (value.index < 0x2000 || (value.bytes != 1 && value.bytes != 2 && value.bytes != 4)) {
        std::abort();
      }
    }
    canopen::requireTorqueDrive(sheet);
  } catch (const canopen::DataSheetError&) {
    // refused, with a section or a line
  }
  return 0;
}
