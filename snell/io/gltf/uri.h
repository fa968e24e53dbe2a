// Uniform resource identifiers, as far as glTF uses them.
#pragma once

#include <string>
#include <string_view>

namespace snell::gltf {

bool is_data_uri(std::string_view uri);

// Whether it begins with a scheme such as "http:"; one letter and a colon are a drive of Windows, not a scheme.
bool has_scheme(std::string_view uri);

// The bytes that a data URI holds, in base64 or percent-encoded. Throws Error beginning with `place`.
std::string decode_data_uri(std::string_view uri, const std::string& place);

// "%20" becomes a space, and so on; what is no such triple stays as it is.
std::string decode_percent(std::string_view text);

} // namespace snell::gltf
