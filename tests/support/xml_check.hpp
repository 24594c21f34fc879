/// A strict little XML reader for tests: says what is wrong with a document's form.
#pragma once

#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace phasescan {

/// Empty if `text` is one well-formed element tree (tags nest, attributes are quoted and unique, entities are known);
/// else what is wrong and where. Void elements of HTML and <!DOCTYPE html> are accepted.
inline std::string xml_error(std::string_view text) {
  std::vector<std::string> open;
  std::size_t i = 0;
  int roots = 0;
  const auto fail = [&](const std::string& what) { return what + " at byte " + std::to_string(i); };
  const auto entity_ok = [&](std::size_t at) {
    for (const std::string_view known : {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"}) {
      if (text.substr(at, known.size()) == known) return true;
    }
    return false;
  };
  const auto is_void = [](const std::string& name) {
    return name == "meta" || name == "br" || name == "hr" || name == "img";
  };
  while (i < text.size()) {
    if (text[i] == '&' && !entity_ok(i)) return fail("unknown entity");
    if (text[i] == '>') return fail("stray >");
    if (text[i] != '<') {
      if (open.empty() && !std::isspace(static_cast<unsigned char>(text[i]))) return fail("text outside the root");
      ++i;
      continue;
    }
    if (text.substr(i, 15) == "<!DOCTYPE html>") {
      i += 15;
      continue;
    }
    ++i;
    const bool closing = i < text.size() && text[i] == '/';
    if (closing) ++i;
    std::string name;
    while (i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) || text[i] == '-')) name += text[i++];
    if (name.empty()) return fail("tag without a name");
    std::vector<std::string> attributes;
    bool self_closing = false;
    while (i < text.size() && text[i] != '>') {
      if (text[i] == '/') {
        self_closing = true;
        ++i;
        continue;
      }
      if (std::isspace(static_cast<unsigned char>(text[i]))) {
        ++i;
        continue;
      }
      std::string key;
      while (i < text.size() && text[i] != '=' && text[i] != '>' && !std::isspace(static_cast<unsigned char>(text[i])))
        key += text[i++];
      if (text.substr(i, 2) != "=\"") return fail("attribute '" + key + "' without a quoted value");
      for (const std::string& other : attributes) {
        if (other == key) return fail("attribute '" + key + "' twice");
      }
      attributes.push_back(key);
      i += 2;
      while (i < text.size() && text[i] != '"') {
        if (text[i] == '<') return fail("< in an attribute");
        if (text[i] == '&' && !entity_ok(i)) return fail("unknown entity");
        ++i;
      }
      ++i;
    }
    if (i >= text.size()) return fail("tag that does not end");
    ++i;
    if (closing) {
      if (open.empty() || open.back() != name) return fail("</" + name + "> closes nothing");
      open.pop_back();
    } else {
      if (open.empty() && ++roots > 1) return fail("a second root");
      if (!self_closing && !is_void(name)) open.push_back(name);
    }
  }
  if (!open.empty()) return "<" + open.back() + "> is never closed";
  return roots == 1 ? "" : "no root";
}

}  // namespace phasescan
