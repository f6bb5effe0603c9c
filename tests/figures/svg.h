/// Drawings as SVG text: panels side by side, each with a caption.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/vec.h"

namespace remesh::figures {

/// A colour in parts of red, green and blue, each from 0 to 1.
struct Colour {
  double red = 0;
  double green = 0;
  double blue = 0;

  friend bool operator==(const Colour&, const Colour&) = default;
};

/// Mixes `amount` of `b` into `a`.
Colour mix(const Colour& a, const Colour& b, double amount);
/// Returns a colour that differs well from those of the neighbouring numbers. The same number always gets the same
/// colour.
Colour colour_of(std::uint32_t number);
std::string hex(const Colour& colour);
/// Formats a value with at most two decimals.
std::string number(double value);

/// One picture: SVG elements in its own coordinates (x to the right, y upwards), and what stands below it.
/// Strokes are in units of the final picture and do not grow with the scale.
class Panel {
 public:
  Panel(std::string title, std::string caption) : title_(std::move(title)), caption_(std::move(caption)) {}

  void polygon(const std::vector<Vec2>& points, const Colour& fill, const Colour& stroke, double stroke_width);
  void line(Vec2 from, Vec2 to, const Colour& stroke, double stroke_width);
  void dot(Vec2 at, double radius, const Colour& fill);
  /// Writes a word with its middle at a place.
  void label(Vec2 at, std::string text, const Colour& fill);

 private:
  friend std::string to_svg(const std::vector<Panel>& panels, double panel_width, double panel_height);

  struct Element {
    enum class Kind { kPolygon, kLine, kDot, kLabel } kind;
    std::vector<Vec2> points;
    Colour fill;
    Colour stroke;
    double width;      ///< width of the stroke, or radius of a dot
    std::string text;  ///< a label shows it

    bool is_like(const Element& other) const {
      return kind == other.kind && fill == other.fill && stroke == other.stroke && width == other.width &&
             text == other.text;
    }
  };

  std::string title_;
  std::string caption_;
  std::vector<Element> elements_;
};

/// Sets panels in rows of two, or three panels in one row. Each is fitted into its field, and all have the same scale.
std::string to_svg(const std::vector<Panel>& panels, double panel_width, double panel_height);

}  // namespace remesh::figures
