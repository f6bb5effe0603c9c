#include "tests/figures/svg.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace remesh::figures {
namespace {

constexpr double kMargin = 16;
constexpr double kCaptionHeight = 58;

/// The data of a path: points in hundredths, each relative to the one before, which is half as long as absolute ones.
class Path {
 public:
  void move_to(Vec2 p) {
    text_ += 'm';
    step(p);
    start_ = at_;
  }
  void line_to(Vec2 p) { step(p); }  // needs no letter after a move
  void close() {
    text_ += 'z';
    at_ = start_;
  }
  const std::string& text() const { return text_; }

 private:
  struct Place {
    long x = 0, y = 0;
  };

  void step(Vec2 to) {
    const Place from = std::exchange(at_, {std::lround(100 * to.x), std::lround(100 * to.y)});
    append(at_.x - from.x);
    append(at_.y - from.y);
  }
  /// Appends a number. If neither a minus nor the letter `m` separates it from the number before, it puts a space
  /// between them.
  void append(long hundredths) {
    if (hundredths < 0)
      text_ += '-';
    else if (text_.back() != 'm')
      text_ += ' ';
    const long whole = std::labs(hundredths) / 100, rest = std::labs(hundredths) % 100;
    if (whole > 0 || rest == 0) text_ += std::to_string(whole);
    if (rest == 0) return;
    text_ += rest < 10 ? ".0" : ".";
    text_ += std::to_string(rest % 10 == 0 ? rest / 10 : rest);
  }

  std::string text_;
  Place at_, start_;
};

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

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  std::string result = text;
  result.erase(result.find_last_not_of('0') + 1);
  if (result.back() == '.') result.pop_back();
  return result == "-0" ? "0" : result;
}

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
  elements_.push_back({Element::Kind::kPolygon, points, fill, stroke, stroke_width, {}});
}

void Panel::line(Vec2 from, Vec2 to, const Colour& stroke, double stroke_width) {
  elements_.push_back({Element::Kind::kLine, {from, to}, {}, stroke, stroke_width, {}});
}

void Panel::dot(Vec2 at, double radius, const Colour& fill) {
  elements_.push_back({Element::Kind::kDot, {at}, fill, {}, radius, {}});
}

void Panel::label(Vec2 at, std::string text, const Colour& fill) {
  elements_.push_back({Element::Kind::kLabel, {at}, fill, {}, 0, std::move(text)});
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

  const std::size_t columns = panels.size() == 3 ? 3 : std::min<std::size_t>(panels.size(), 2);
  const std::size_t rows = (panels.size() + columns - 1) / columns;
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
      return Vec2{centre.x + scale * (p.x - middle.x), centre.y - scale * (p.y - middle.y)};
    };
    const auto& elements = panels[i].elements_;
    for (std::size_t from = 0, to = 0; from < elements.size(); from = to) {
      // Consecutive elements that look alike become one path, or one group of dots.
      const auto& first = elements[from];
      while (to < elements.size() && elements[to].is_like(first)) ++to;
      if (first.kind == Panel::Element::Kind::kLabel) {
        const Vec2 at = place(first.points[0]);
        svg += "<text x=\"" + number(at.x) + "\" y=\"" + number(at.y + 4) + "\" font-size=\"13\" fill=\"" +
               hex(first.fill) + "\">" + escaped(first.text) + "</text>\n";
        continue;
      }
      svg += first.kind == Panel::Element::Kind::kDot ? "<g" : "<path";
      if (first.kind != Panel::Element::Kind::kLine) svg += " fill=\"" + hex(first.fill) + "\"";
      if (first.kind == Panel::Element::Kind::kDot) {
        svg += ">\n";
        for (std::size_t e = from; e < to; ++e) {
          const Vec2 at = place(elements[e].points[0]);
          svg +=
              "<circle cx=\"" + number(at.x) + "\" cy=\"" + number(at.y) + "\" r=\"" + number(first.width) + "\"/>\n";
        }
        svg += "</g>\n";
        continue;
      }
      Path path;
      for (std::size_t e = from; e < to; ++e) {
        const std::vector<Vec2>& points = elements[e].points;
        path.move_to(place(points[0]));
        for (std::size_t k = 1; k < points.size(); ++k) path.line_to(place(points[k]));
        if (first.kind == Panel::Element::Kind::kPolygon) path.close();
      }
      svg += " stroke=\"" + hex(first.stroke) + "\" stroke-width=\"" + number(first.width) + "\" d=\"" + path.text() +
             "\"/>\n";
    }
    const std::string x = number(centre.x);
    svg += "<text x=\"" + x + "\" y=\"" + number(top + panel_height + 14) +
           "\" font-size=\"17\" font-weight=\"bold\" " + "fill=\"#1d2733\">" + escaped(panels[i].title_) + "</text>\n";
    svg += "<text x=\"" + x + "\" y=\"" + number(top + panel_height + 37) + "\" font-size=\"14\" fill=\"#4a5663\">" +
           escaped(panels[i].caption_) + "</text>\n";
  }
  return svg + "</g>\n</svg>\n";
}

}  // namespace remesh::figures
