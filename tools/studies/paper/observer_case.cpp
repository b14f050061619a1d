#include "tools/studies/paper/observer_case.hpp"

#include <cctype>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "firmware_app/files/file_error.hpp"

namespace patella::study {
namespace {

using nlohmann::json;

std::string observerSettings(const PaperOptions& options) {
  return fmt::format("{} s, tuned on {} seeds", options.seconds, options.tuning_seeds);
}

std::string fileName(const PaperOptions& options, const Condition& condition, const Method& method) {
  std::string name =
      fmt::format("{}_{}_", condition.corrected ? "corrected" : "as_printed", numberOf(condition.experiment));
  for (const char c : method.name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (plain || name.back() != '_') {
      name += plain ? c : '_';
    }
  }
  return name + fmt::format("_{}seeds", options.seeds);
}

}  // namespace

ObserverMaterial observerMaterial(const PaperOptions& options, const Condition& condition) {
  return {recordAll(condition, options.seconds, kFirstTuningSeed, options.tuning_seeds),
          recordAll(condition, options.seconds, 1, options.seeds)};
}

std::optional<Result> findObserver(const KeptResults& kept, const PaperOptions& options,
                                   const Condition& condition, const Method& method) {
  const std::string name = fileName(options, condition, method);
  const std::optional<json> found = kept.find(name, observerSettings(options));
  if (!found) {
    return std::nullopt;
  }
  Result result{.condition = condition, .method = &method, .values = {}, .error = {}, .delay_s = {}};
  try {
    found->at("values").get_to(result.values);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const json& one = found->at("joints").at(joint);
      result.error[joint] = {one.at("error").get<double>(), one.at("error_sd").get<double>()};
      result.delay_s[joint] = {one.at("delay_s").get<double>(), one.at("delay_sd_s").get<double>()};
    }
  } catch (const json::exception& error) {
    throw app::FileError(kept.beside(name, ".json").string() + ": damaged: " + error.what() +
                         "; remove it to have it made anew");
  }
  return result;
}

Result measureObserver(const KeptResults& kept, const PaperOptions& options, const ObserverMaterial& material,
                       const Method& method) {
  const Result result = measure(method, material.tuning, material.measured);
  json joints = json::array();
  for (std::size_t joint = 0; joint < 2; ++joint) {
    joints.push_back({{"error", result.error[joint].mean},
                      {"error_sd", result.error[joint].deviation},
                      {"delay_s", result.delay_s[joint].mean},
                      {"delay_sd_s", result.delay_s[joint].deviation}});
  }
  kept.keep(fileName(options, result.condition, method), observerSettings(options),
            {{"method", method.name}, {"values", result.values}, {"joints", joints}});
  return result;
}

}  // namespace patella::study
