#include "tests/figures/svg.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace remesh::figures {
namespace {

constexpr double kMargin = 16;
constexpr double kCaptionHeight = 58;

/// A number with at most two decimals.
std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  std::string result = text;
  result.erase(result.find_last_not_of('0') + 1);
  if (result.back() == '.') result.pop_back();
  return result == "-0" ? "0" : result;
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      default: result += c;
    }
  }
  return result;
}

}  // namespace

Colour mix(const Colour& a, const Colour& b, double amount) {
  const auto between = [amount](double x, double y) { return x + amount * (y - x); };
  return {between(a.red, b.red), between(a.green, b.green), between(a.blue, b.blue)};
}

Colour colour_of(std::uint32_t number) {
  // The golden angle keeps successive hues far apart.
  const double hue = std::fmod(0.56 + 0.6180339887498949 * number, 1.0) * 6;
  const auto channel = [hue](double shift) {
    const double k = std::fmod(hue + shift, 6.0);
    return 0.60 + 0.32 * std::clamp(std::fabs(k - 3) - 1, 0.0, 1.0);
  };
  return {channel(0), channel(4), channel(2)};
}

std::string hex(const Colour& colour) {
  const auto byte = [](double x) { return static_cast<unsigned>(std::lround(std::clamp(x, 0.0, 1.0) * 255)); };
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", byte(colour.red), byte(colour.green), byte(colour.blue));
  return text;
}

void Panel::polygon(const std::vector<Vec2>& points, const Colour& fill, const Colour& stroke, double stroke_width) {
  elements_.push_back({Element::Kind::kPolygon, points, fill, stroke, stroke_width});
}

void Panel::line(Vec2 from, Vec2 to, const Colour& stroke, double stroke_width) {
  elements_.push_back({Element::Kind::kLine, {from, to}, {}, stroke, stroke_width});
}

void Panel::dot(Vec2 at, double radius, const Colour& fill) {
  elements_.push_back({Element::Kind::kDot, {at}, fill, {}, radius});
}

std::string to_svg(const std::vector<Panel>& panels, double panel_width, double panel_height) {
  struct Extent {
    Vec2 low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
  };
  std::vector<Extent> extents;
  double scale = HUGE_VAL;
  for (const Panel& panel : panels) {
    Extent extent;
    for (const auto& element : panel.elements_) {
      for (const Vec2 p : element.points) {
        extent.low = {std::min(extent.low.x, p.x), std::min(extent.low.y, p.y)};
        extent.high = {std::max(extent.high.x, p.x), std::max(extent.high.y, p.y)};
      }
    }
    scale = std::min({scale, (panel_width - 2 * kMargin) / (extent.high.x - extent.low.x),
                      (panel_height - 2 * kMargin) / (extent.high.y - extent.low.y)});
    extents.push_back(extent);
  }

  const std::size_t columns = std::min<std::size_t>(panels.size(), 2), rows = (panels.size() + columns - 1) / columns;
  const std::string width = number(panel_width * static_cast<double>(columns));
  const std::string height = number((panel_height + kCaptionHeight) * static_cast<double>(rows));
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + width + " " + height + "\" width=\"" +
                    width + "\" height=\"" + height + "\">\n" + "<rect width=\"" + width + "\" height=\"" + height +
                    "\" rx=\"8\" fill=\"#ffffff\"/>\n" +
                    "<g stroke-linejoin=\"round\" stroke-linecap=\"round\" "
                    "font-family=\"Helvetica,Arial,sans-serif\" text-anchor=\"middle\">\n";
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const Vec2 middle = 0.5 * (extents[i].low + extents[i].high);
    const double top = static_cast<double>(i / columns) * (panel_height + kCaptionHeight);
    const Vec2 centre{(static_cast<double>(i % columns) + 0.5) * panel_width, top + 0.5 * panel_height};
    const auto place = [&](Vec2 p) {
      return number(centre.x + scale * (p.x - middle.x)) + " " + number(centre.y - scale * (p.y - middle.y));
    };
    std::string open_stroke;  // the group that the last element stands in
    const auto in_group = [&](const std::string& stroke) {
      if (stroke == open_stroke) return;
      if (!open_stroke.empty()) svg += "</g>\n";
      if (!stroke.empty()) svg += "<g " + stroke + ">\n";
      open_stroke = stroke;
    };
    for (const auto& element : panels[i].elements_) {
      if (element.kind == Panel::Element::Kind::kDot) {
        in_group("");
        std::string at = place(element.points[0]);
        at.replace(at.find(' '), 1, "\" cy=\"");
        svg += "<circle cx=\"" + at + "\" r=\"" + number(element.width) + "\" fill=\"" + hex(element.fill) + "\"/>\n";
        continue;
      }
      in_group("stroke=\"" + hex(element.stroke) + "\" stroke-width=\"" + number(element.width) + "\"");
      svg += "<path d=\"M";
      for (std::size_t k = 0; k < element.points.size(); ++k) svg += (k > 0 ? "L" : "") + place(element.points[k]);
      if (element.kind == Panel::Element::Kind::kPolygon) svg += "Z\" fill=\"" + hex(element.fill);
      svg += "\"/>\n";
    }
    in_group("");
    const std::string x = number(centre.x);
    svg += "<text x=\"" + x + "\" y=\"" + number(top + panel_height + 14) +
           "\" font-size=\"17\" font-weight=\"bold\" " + "fill=\"#1d2733\">" + escaped(panels[i].title_) + "</text>\n";
    svg += "<text x=\"" + x + "\" y=\"" + number(top + panel_height + 37) + "\" font-size=\"14\" fill=\"#4a5663\">" +
           escaped(panels[i].caption_) + "</text>\n";
  }
  return svg + "</g>\n</svg>\n";
}

}  // namespace remesh::figures
