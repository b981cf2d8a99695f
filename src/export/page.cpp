#include "export/page.h"

#include <openssl/evp.h>

#include <cerrno>
#include <cstdio>
#include <memory>

#include "export/frames.h"
#include "export/web_files.h"
#include "run/atomic_file.h"

namespace froude::exporting {
namespace {

/// Text of HTML, or of a script of JSON: with "<" spelled out neither can end its element.
std::string escapedText(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
  return out;
}

std::string escapedJson(std::string_view json) {
  std::string out;
  out.reserve(json.size() + json.size() / 64);
  for (const char c : json) {
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

std::string base64(std::string_view bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int length =
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                      reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

class PageFile {
 public:
  explicit PageFile(const std::string& file)
      : name_(file), pending_(file), stream_(std::fopen(pending_.path().c_str(), "wb"), std::fclose) {
    if (!stream_) run::throwOutputError(file);
  }
  PageFile& operator<<(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stream_.get()) != text.size()) run::throwOutputError(name_);
    return *this;
  }
  void commit() {
    if (std::fclose(stream_.release()) != 0) run::throwOutputError(name_);
    pending_.commit();
  }

 private:
  std::string name_;
  run::PendingFile pending_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_;
};

}  // namespace

void writePage(const std::string& file, const PageParts& parts) {
  PageFile page(file);
  page << "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
          "<link rel=\"icon\" href=\"data:,\">\n<title>"
       << escapedText(parts.title) << "</title>\n<style>\n"
       << web::kStyle << "</style>\n</head>\n<body>\n<main id=\"page\"></main>\n"
       << "<script type=\"application/json\" id=\"data\">" << escapedJson(parts.json) << "</script>\n";
  if (parts.blocks)
    parts.blocks([&](std::string_view block) {
      page << "<script type=\"text/plain\" class=\"frames\">" << base64(block) << "</script>\n";
    });
  page << "<script>\n" << web::kProgram << "</script>\n</body>\n</html>\n";
  page.commit();
}

std::string_view pageNotices() { return web::kNotices; }

}  // namespace froude::exporting
