// index.html: one file that carries its style, its program and its data, and opens without a network.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace froude::exporting {

/// What a page is made from: a title, a document of JSON that its program reads, and, for runs, blocks of frames.
struct PageParts {
  std::string title;
  std::string json;
  /// Calls its argument with the bytes of each block, in order; empty: there are none. Blocks are held one at a time.
  std::function<void(const std::function<void(std::string_view)>&)> blocks;
};

/// Writes the page beside and renames it. Throws OutputError.
void writePage(const std::string& file, const PageParts& parts);

/// Notices of the libraries whose code stands in every page.
std::string_view pageNotices();

}  // namespace froude::exporting
