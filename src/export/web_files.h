// The built files of src/export/web/dist, as the build puts them into the program.
#pragma once

#include <string_view>

namespace froude::exporting::web {

extern const std::string_view kStyle, kProgram, kNotices;

}  // namespace froude::exporting::web
