// The SHA-256 of a text, so that a run can be traced to the very bytes of its scene.
#pragma once

#include <string>

namespace froude::scene {

/// 64 lower-case hexadecimal digits (FIPS 180-4), by OpenSSL's libcrypto.
std::string sha256(const std::string& bytes);

}  // namespace froude::scene
