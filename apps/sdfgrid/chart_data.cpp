#include "chart_data.h"

#include <algorithm>
#include <cmath>

namespace sdfgrid::cli {
namespace {

Json json_of(const ErrorSummary& summary) {
  return {{"samples", summary.samples},       {"max_error", summary.max_error},
          {"p99_error", summary.p99_error},   {"rms_error", summary.rms_error},
          {"mean_error", summary.mean_error}, {"sign_errors", summary.sign_errors}};
}

Json json_of(const ChartPoint& point) {
  Json json = {{"method", point.method},
               {"peer", point.peer},
               {"dim", point.dim},
               {"voxel", point.survey.voxel},
               {"seconds", point.seconds},
               {"peak_memory", point.peak_memory},
               {"bytes", point.bytes},
               {"active_voxels", point.active_voxels},
               {"on_front", point.on_front},
               {"between", json_of(point.survey.between)},
               {"voxels", json_of(point.survey.voxels)}};
  for (std::size_t part = 0; part < kFieldParts.size(); ++part) {
    json[std::string(kFieldParts[part])] = json_of(point.survey.parts[part]);
  }
  return json;
}

std::string cells_of(const ErrorSummary& summary) {
  return fmt::format(",{},{:.6g},{:.6g},{:.6g},{}", summary.samples, summary.max_error,
                     summary.p99_error, summary.rms_error, summary.sign_errors);
}

// No worse in either, and better in one.
bool beats(const ChartPoint& a, const ChartPoint& b) {
  const double error_a = a.survey.between.max_error;
  const double error_b = b.survey.between.max_error;
  return a.seconds <= b.seconds && error_a <= error_b &&
         (a.seconds < b.seconds || error_a < error_b);
}

}  // namespace

void mark_front(std::vector<ChartPoint>& points) {
  for (ChartPoint& point : points) {
    point.on_front = std::none_of(points.begin(), points.end(),
                                  [&](const ChartPoint& other) { return beats(other, point); });
  }
}

double order_of(const std::vector<ChartPoint>& points, const std::string& method,
                std::size_t part) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const ChartPoint& point : points) {
    const ErrorSummary& summary = point.survey.parts[part];
    if (point.method != method || summary.samples == 0 || !(summary.rms_error > 0)) continue;
    const double u = std::log(point.survey.voxel);
    const double v = std::log(summary.rms_error);
    n += 1;
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  return n < 2 ? NAN : (n * xy - x * y) / (n * xx - x * x);
}

std::vector<std::string> methods_of(const std::vector<ChartPoint>& points) {
  std::vector<std::string> methods;
  for (const ChartPoint& point : points) {
    if (std::find(methods.begin(), methods.end(), point.method) == methods.end()) {
      methods.push_back(point.method);
    }
  }
  return methods;
}

std::string csv_of(const std::vector<ChartPoint>& points) {
  std::string csv = "method,dim,voxel,seconds,peak_memory,bytes,active_voxels,on_front";
  std::vector<std::string> kinds = {"between", "voxels"};
  kinds.insert(kinds.end(), kFieldParts.begin(), kFieldParts.end());
  for (const std::string& kind : kinds) {
    csv += fmt::format(",{0}_samples,{0}_max,{0}_p99,{0}_rms,{0}_sign_errors", kind);
  }
  csv += '\n';
  for (const ChartPoint& p : points) {
    csv += fmt::format("{},{},{:.9g},{:.6g},{:.0f},{},{},{}", p.method, p.dim, p.survey.voxel,
                       p.seconds, p.peak_memory, p.bytes, p.active_voxels, p.on_front ? 1 : 0);
    csv += cells_of(p.survey.between) + cells_of(p.survey.voxels);
    for (const ErrorSummary& part : p.survey.parts) csv += cells_of(part);
    csv += '\n';
  }
  return csv;
}

Json json_of(const std::vector<ChartPoint>& points) {
  Json json = {{"points", Json::array()}, {"orders", Json::object()}};
  for (const ChartPoint& point : points) json["points"].push_back(json_of(point));
  for (const std::string& method : methods_of(points)) {
    for (std::size_t part = 0; part < kFieldParts.size(); ++part) {
      const double order = order_of(points, method, part);
      json["orders"][method][std::string(kFieldParts[part])] =
          std::isfinite(order) ? Json(order) : Json();
    }
  }
  return json;
}

}  // namespace sdfgrid::cli
