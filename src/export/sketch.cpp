#include "export/sketch.h"

#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>

#include "export/frames.h"

namespace froude::exporting {
namespace {

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

cairo_status_t append(void* to, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

void expectDrawn(cairo_status_t status, const std::string& file) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw OutputError(fmt::format("{}: cannot be drawn: {}", file, cairo_status_to_string(status)));
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out;
}

}  // namespace

void setGrey(cairo_t* cr, double level) { cairo_set_source_rgb(cr, level, level, level); }

void setColor(cairo_t* cr, Color color, double opacity) {
  cairo_set_source_rgba(cr, color.r / 255.0, color.g / 255.0, color.b / 255.0, opacity);
}

void setFont(cairo_t* cr, double size) {
  cairo_select_font_face(cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr, size);
}

double textWidth(cairo_t* cr, const std::string& text) {
  cairo_text_extents_t e;
  cairo_text_extents(cr, text.c_str(), &e);
  return e.x_advance;
}

void drawText(cairo_t* cr, const std::string& text, double x, double y, double align) {
  cairo_move_to(cr, x - align * textWidth(cr, text), y);
  cairo_show_text(cr, text.c_str());
}

std::string shortened(cairo_t* cr, const std::string& text, double room) {
  if (textWidth(cr, text) <= room) return text;
  std::string start = text;
  while (!start.empty() && textWidth(cr, start + "…") > room) {
    while (!start.empty() && (static_cast<unsigned char>(start.back()) & 0xC0u) == 0x80u) start.pop_back();
    if (!start.empty()) start.pop_back();
  }
  return start + "…";
}

std::string lengthLabel(double metres) {
  if (metres >= 1000.0) return fmt::format("{:g} km", metres / 1000.0);
  if (metres >= 1.0) return fmt::format("{:g} m", metres);
  if (metres >= 0.01) return fmt::format("{:g} cm", metres * 100.0);
  if (metres >= 0.001) return fmt::format("{:g} mm", metres * 1000.0);
  return fmt::format("{:g} µm", metres * 1e6);
}

void drawScaleBar(cairo_t* cr, const ScaleBar& bar) {
  const double tick = 5.0 * bar.unit, end = bar.x + bar.metres * bar.pixels;
  cairo_set_line_width(cr, 2.0 * bar.unit);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_BUTT);
  cairo_move_to(cr, bar.x, bar.y - tick);
  cairo_line_to(cr, bar.x, bar.y + tick);
  cairo_move_to(cr, bar.x, bar.y);
  cairo_line_to(cr, end, bar.y);
  cairo_move_to(cr, end, bar.y - tick);
  cairo_line_to(cr, end, bar.y + tick);
  cairo_stroke(cr);
  cairo_set_font_size(cr, 16.0 * bar.unit);
  drawText(cr, lengthLabel(bar.metres), 0.5 * (bar.x + end), bar.y + 26.0 * bar.unit, 0.5);
}

std::string drawSheet(const std::string& file, const Sheet& sheet, FunctionRef<void(cairo_t*)> paint) {
  if (!file.ends_with(".svg")) {
    const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, sheet.width, sheet.height),
                          cairo_surface_destroy);
    const Context context(cairo_create(surface.get()), cairo_destroy);
    paint(context.get());
    return pngBytes(context.get(), surface.get(), file);
  }
  std::string svg;
  {
    const Surface surface(cairo_svg_surface_create_for_stream(append, &svg, sheet.width, sheet.height),
                          cairo_surface_destroy);
    cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
    const Context context(cairo_create(surface.get()), cairo_destroy);
    paint(context.get());
    cairo_surface_finish(surface.get());
    expectDrawn(std::max(cairo_status(context.get()), cairo_surface_status(surface.get())), file);
  }
  const std::size_t head = svg.find("<svg");
  const std::size_t end = head == std::string::npos ? head : svg.find('>', head);
  if (end != std::string::npos)
    svg.insert(end + 1,
               fmt::format("\n<title>{}</title>\n<desc>{}</desc>", escaped(sheet.title), escaped(sheet.description)));
  return svg;
}

std::string pngBytes(cairo_t* cr, cairo_surface_t* surface, const std::string& file) {
  std::string png;
  cairo_status_t status = cairo_status(cr);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_write_to_png_stream(surface, append, &png);
  expectDrawn(status, file);
  return png;
}

}  // namespace froude::exporting
