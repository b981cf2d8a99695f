// Reading TOML into a tree of nodes, and the changes that --set makes to it.
#pragma once

#include <optional>
#include <string>

#include "scene/node.h"

namespace froude::scene {

/// All bytes of a file that a person wrote. SceneError, with `right` as in "a scene (.toml)".
std::string readText(const std::string& file, const std::string& right);

/// Parses a whole file. SceneError at the place where it stops being TOML. `file` is used in messages only.
Node parseDocument(const std::string& file, const std::string& text);

/// Parses one TOML value; a text that is none of TOML is taken as a string. Empty for a text that can be neither
/// (empty, broken quotes or brackets, more than one line).
std::optional<Node> parseValue(const std::string& text);

/// Sets PATH to VALUE in the document. Tables on the way are made where the file left them out; tables of an array are
/// named by index or by their `name`. SceneError for a path or a value that cannot be meant.
void applyOverride(Node& document, const std::string& file, const Override& change);

/// The known word with the smallest edit distance (a swap of neighbours counts once); empty if none is known.
std::string nearest(const std::string& word, const std::vector<std::string>& known);
/// `, the nearest is "WORD"` or nothing.
std::string suggestion(const std::string& word, const std::vector<std::string>& known);

}  // namespace froude::scene
