#include "snell/io/gltf/buffers.h"

#include "snell/core/parallel.h"
#include "snell/io/file.h"
#include "snell/io/gltf/uri.h"

#include <meshoptimizer.h>

#include <map>

namespace fs = std::filesystem;

namespace snell::gltf {
namespace {

constexpr const char* extension = "EXT_meshopt_compression";

[[noreturn]] void fail(const std::string& who, const std::string& what)
{
    throw Error(fmt::format("{}: {}", who, what), "write the file again");
}

} // namespace

fs::path find_file(const std::string& uri, const std::string& place, References& references)
{
    const std::string decoded = decode_percent(uri);
    const fs::path file = references.resolve(decoded, place);
    std::error_code error;
    if (decoded == uri || fs::exists(file, error)) return file;
    // Some writers do not encode, so that a '%' is just that.
    const fs::path as_written = references.resolve(uri, place);
    return fs::exists(as_written, error) ? as_written : file;
}

Buffers::Buffers(const Document& document, References& references, Budget& budget) : document_(document)
{
    budget.allow(document.bytes.size());
    load(references, budget);

    const auto& views = document.model.bufferViews;
    views_.resize(views.size());
    unpacked_.resize(views.size());
    std::vector<std::size_t> packed;
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (Fields(views[i].extensions, extension).exists())
            packed.push_back(i);
        else
            views_[i] = range(views[i].buffer, views[i].byteOffset, views[i].byteLength,
                              label("buffer view", i, views[i].name));
    }
    parallel_for(packed.size(), [&](std::size_t i) { unpack(packed[i], budget); });
}

void Buffers::load(References& references, Budget& budget)
{
    const auto& sources = document_.buffers;
    owned_.resize(sources.size());
    buffers_.resize(sources.size());
    std::map<fs::path, std::shared_ptr<const std::string>> files;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const BufferSource& source = sources[i];
        const std::string who = label("buffer", i, source.name);
        if (source.uri.empty()) {
            // Only the first buffer may be the binary chunk. Any other is a stand-in whose data is compressed
            // elsewhere.
            if (i == 0 && document_.has_binary) buffers_[i] = document_.binary;
        } else if (is_data_uri(source.uri)) {
            owned_[i] = std::make_shared<const std::string>(decode_data_uri(source.uri, who + ": "));
            buffers_[i] = *owned_[i];
        } else {
            const fs::path file = find_file(source.uri, who + ": ", references);
            auto& bytes = files[file];
            if (!bytes) {
                bytes = std::make_shared<const std::string>(read_file(file));
                budget.allow(bytes->size());
            }
            owned_[i] = bytes;
            buffers_[i] = *bytes;
        }
        if (buffers_[i].data() == nullptr) continue;
        if (buffers_[i].size() < source.size)
            fail(who, fmt::format("should have {} bytes and has {}: it is cut off", source.size, buffers_[i].size()));
        buffers_[i] = buffers_[i].substr(0, source.size);
        total_bytes_ += source.size;
    }
}

std::string_view Buffers::range(int buffer, std::size_t offset, std::size_t size, const std::string& who) const
{
    checked(document_.buffers, buffer, "buffer", who);
    const std::string_view bytes = buffers_[static_cast<std::size_t>(buffer)];
    if (bytes.data() == nullptr) fail(who, fmt::format("is in buffer {}, which has no data", buffer));
    if (offset > bytes.size() || size > bytes.size() - offset)
        fail(who, fmt::format("{} bytes at {} are more than buffer {} has: {}", size, offset, buffer, bytes.size()));
    return bytes.substr(offset, size);
}

// The layout is that of the extension's specification; the library's decoders check the packed bytes themselves, so
// here it is about sizes.
void Buffers::unpack(std::size_t view, Budget& budget)
{
    const tinygltf::BufferView& description = document_.model.bufferViews[view];
    const std::string who = label("buffer view", view, description.name);
    const Fields fields(description.extensions, extension);
    const std::string mode = fields.text("mode"), filter = fields.text("filter");
    const std::size_t count = fields.size("count", 0), stride = fields.size("byteStride", 0);
    const std::string_view packed =
        range(fields.integer("buffer", -1), fields.size("byteOffset", 0), fields.size("byteLength", 0), who);
    const auto* const bytes = reinterpret_cast<const unsigned char*>(packed.data());

    const bool is_vertices = mode == "ATTRIBUTES";
    if (is_vertices ? stride == 0 || stride % 4 != 0 || stride > 256 : stride != 2 && stride != 4)
        fail(who, fmt::format("its packed data has a stride of {} bytes", stride));
    // A vertex takes at least 2 bits a byte in blocks of 16; an index sequence a byte an index, a triangle a byte.
    constexpr std::size_t best_ratio = 64;
    if (count > (packed.size() + 1) * best_ratio / (is_vertices ? stride : 1) + 16)
        fail(who, fmt::format("{} packed bytes cannot hold {} elements", packed.size(), count));
    budget.charge(count, stride, who + ": ");
    std::string& out = unpacked_[view];
    out.resize(count * stride);

    int result = 0;
    if (mode == "ATTRIBUTES")
        result = meshopt_decodeVertexBuffer(out.data(), count, stride, bytes, packed.size());
    else if (mode == "TRIANGLES" && count % 3 == 0)
        result = meshopt_decodeIndexBuffer(out.data(), count, stride, bytes, packed.size());
    else if (mode == "INDICES")
        result = meshopt_decodeIndexSequence(out.data(), count, stride, bytes, packed.size());
    else
        fail(who, fmt::format("packed data of mode '{}' with {} elements", mode, count));
    if (result != 0) fail(who, "its packed data is damaged");

    if (filter.empty() || filter == "NONE") {
    } else if (filter == "OCTAHEDRAL" && is_vertices && (stride == 4 || stride == 8)) {
        meshopt_decodeFilterOct(out.data(), count, stride);
    } else if (filter == "QUATERNION" && is_vertices && stride == 8) {
        meshopt_decodeFilterQuat(out.data(), count, stride);
    } else if (filter == "EXPONENTIAL" && is_vertices) {
        meshopt_decodeFilterExp(out.data(), count, stride);
    } else {
        fail(who, fmt::format("packed data with the filter '{}' and a stride of {}", filter, stride));
    }
    views_[view] = out;
}

std::string_view Buffers::view(int index, const std::string& who) const
{
    return checked(views_, index, "buffer view", who);
}

} // namespace snell::gltf
