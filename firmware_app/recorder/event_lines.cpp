#include "firmware_app/recorder/event_lines.hpp"

#include <algorithm>

#include "core/safety/fault.hpp"
#include "core/safety/state_machine.hpp"
#include "core/safety/warning.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {

bool EventLines::next(const TickRecord& record, std::string& line) {
  const bool noticed = std::any_of(
      record.notices.begin(), record.notices.end(),
      [](const canopen::NodeNotice& notice) { return notice.kind != canopen::NoticeKind::kNone; });
  if (record.state == last_state_ && record.faults == last_faults_ && record.missed_periods == 0 &&
      record.warnings == last_warnings_ && !noticed) {
    return false;
  }
  line = "t_s=" + formatNumber(record.time_s) + " state=";
  line += safety::stateName(static_cast<safety::State>(record.state));
  appendCauses(record, line);
  appendWarnings(record, line);
  if (record.missed_periods != 0) {
    line += " missed_periods=" + std::to_string(record.missed_periods);
  }
  for (const canopen::NodeNotice& notice : record.notices) {
    if (notice.kind != canopen::NoticeKind::kNone) {
      line += " " + canopen::noticeText(notice);
    }
  }
  last_state_ = record.state;
  last_faults_ = record.faults;
  last_warnings_ = record.warnings;
  return true;
}

void EventLines::appendCauses(const TickRecord& record, std::string& line) const {
  bool raised = false;
  for (int i = 0; i < safety::kFaultCount; ++i) {
    const auto fault = static_cast<safety::Fault>(i);
    const bool is = safety::FaultSet(record.faults).has(fault);
    const bool was = safety::FaultSet(last_faults_).has(fault);
    raised = raised || (is && !was);
    if (is != was) {
      line += std::string(is ? " raised=" : " cleared=") + std::string(safety::faultName(fault));
    }
  }
  for (std::size_t bus = 0; raised && bus < buses_.size(); ++bus) {
    if ((record.fault_buses & can::busBit(bus)) != 0 && !buses_[bus].name.empty()) {
      line += " bus=" + buses_[bus].name;
    }
  }
}

void EventLines::appendWarnings(const TickRecord& record, std::string& line) const {
  for (int i = 0; i < safety::kWarningCount; ++i) {
    const auto warning = static_cast<safety::Warning>(i);
    const bool is = safety::WarningSet(record.warnings).has(warning);
    if (is != safety::WarningSet(last_warnings_).has(warning)) {
      line += std::string(is ? " warning=" : " no_longer=") + std::string(safety::warningName(warning));
    }
  }
}

}  // namespace patella::app
