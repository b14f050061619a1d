// Writes the page of a made-up diagnosis, for a browser to look at.
#include <exception>
#include <iostream>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/unit/diagnose_io/made_up_diagnosis.hpp"
#include "tools/diagnose/output/diagnosis_report.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: made_up_page PAGE.html\n";
    return 2;
  }
  try {
    patella::app::writeFile(argv[1], patella::diagnose::diagnosisPage(patella::test::madeUpDiagnosis()));
  } catch (const std::exception& error) {
    std::cerr << "made_up_page: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
