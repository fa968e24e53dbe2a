#include "snell/io/obj/parse.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/io/byte_window.h"
#include "snell/io/obj/chunk.h"
#include "snell/io/obj/corner_table.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace snell::obj {
namespace {

constexpr const char* const kind_names[kind_count] = {"vertex", "texture coordinate", "normal"};
constexpr const char* const skipped_names[skipped_count] = {
    "lines and points are not drawn", "free-form curves and surfaces are not supported and left out",
    "unknown keywords are skipped", "numbers that are not finite", nullptr};

// The distinct names in order of first appearance.
class Names
{
  public:
    explicit Names(std::vector<std::string>& names) : names_(names) {}

    uint number(const std::string& name)
    {
        const auto [entry, is_new] = numbers_.try_emplace(name, static_cast<uint>(names_.size()));
        if (is_new) names_.push_back(name);
        return entry->second;
    }

  private:
    std::vector<std::string>& names_;
    std::unordered_map<std::string, uint> numbers_;
};

// Joins chunks, in the order of the file, to a document.
class Joiner
{
  public:
    Joiner(const std::string& file, Document& document)
        : file_(file), document_(document), objects_(document.objects), materials_(document.materials)
    {
        state_.material = materials_.number("");
        state_.object = objects_.number("");
    }

    // left: how much more of the file there is, in chunks of this size; a guess.
    void add(const Chunk& chunk, double left)
    {
        const std::size_t bases[kind_count] = {document_.positions.size(), document_.uvs.size(),
                                               document_.normals.size()};
        check(chunk, bases);
        append(document_.positions, chunk.positions, left);
        append(document_.uvs, chunk.uvs, left);
        append(document_.normals, chunk.normals, left);
        if (document_.positions.size() > most) fail(line_, "more than 2147483647 vertices", "split the file");
        if (!chunk.colors.empty() && document_.colors.empty()) document_.colors.assign(bases[kind_position], vec3(1));
        if (!chunk.colors.empty())
            append(document_.colors, chunk.colors, left);
        else if (!document_.colors.empty())
            document_.colors.resize(document_.positions.size(), vec3(1.0f));
        add_corners(chunk, bases, left);
        add_faces(chunk, left);
        add_events(chunk);
        for (int i = 0; i < skipped_count; ++i) {
            if (skipped_[i].count == 0) skipped_[i].first_line = line_ + chunk.skipped[i].first_line;
            skipped_[i].count += chunk.skipped[i].count;
        }
        line_ += chunk.lines;
    }

    void finish()
    {
        const std::size_t counts[kind_count] = {document_.positions.size(), document_.uvs.size(),
                                                document_.normals.size()};
        for (int k = 0; k < kind_count; ++k)
            if (highest_[k].index >= 0 && static_cast<std::size_t>(highest_[k].index) >= counts[k])
                fail(highest_[k].line,
                     fmt::format("{} {} is referred to, but the file has {}", kind_names[k], highest_[k].written,
                                 counts[k]),
                     "it is truncated or damaged: get or write it again");
        table_.finish();
        document_.vertices = std::move(table_.keys());
        for (int i = 0; i < skipped_small_face; ++i)
            if (const Tally& tally = skipped_[i]; tally.count > 0)
                document_.warnings.push_back(fmt::format("{}:{}: {} ({} such line{})", file_, tally.first_line,
                                                         skipped_names[i], tally.count, tally.count == 1 ? "" : "s"));
        if (const Tally& tally = skipped_[skipped_small_face]; tally.count > 0)
            document_.warnings.push_back(fmt::format("{}:{}: {} faces have less than three corners and are dropped",
                                                     file_, tally.first_line, tally.count));
    }

  private:
    static constexpr std::size_t most = std::numeric_limits<int>::max();

    [[noreturn]] void fail(int line, const std::string& message, const std::string& remedy, int column = 0) const
    {
        throw Error({file_, line, column}, message, remedy);
    }

    // Makes room for what is likely to come as well, so that little is copied and no memory is left over.
    template <class T>
    static void make_room(std::vector<T>& to, std::size_t added, double left)
    {
        if (to.size() + added <= to.capacity()) return;
        constexpr double margin = 1.05, most_ahead = 1e4;
        const double likely = static_cast<double>(added) * (1.0 + margin * std::min(left, most_ahead));
        to.reserve(std::max(to.size() + static_cast<std::size_t>(likely), to.capacity() + to.capacity() / 4));
    }

    template <class T>
    static void append(std::vector<T>& to, const std::vector<T>& from, double left)
    {
        make_room(to, from.size(), left);
        to.insert(to.end(), from.begin(), from.end());
    }

    // The first thing in the chunk that is wrong, if it can be known already.
    void check(const Chunk& chunk, const std::size_t (&bases)[kind_count])
    {
        const Chunk::Reach* wrong = nullptr;
        int wrong_kind = 0;
        for (int k = 0; k < kind_count; ++k) {
            const Chunk::Reach& back = chunk.lowest[k];
            const bool is_wrong = back.index < 0 && static_cast<std::size_t>(-static_cast<long>(back.index)) > bases[k];
            if (is_wrong && (!wrong || back.line < wrong->line)) wrong = &back, wrong_kind = k;
            if (chunk.highest[k].index > highest_[k].index) {
                highest_[k] = chunk.highest[k];
                highest_[k].line += line_;
            }
        }
        if (wrong && !(chunk.failed && chunk.error_line < wrong->line))
            fail(line_ + wrong->line,
                 fmt::format("{} {} is referred to, but there are only {} before this line", kind_names[wrong_kind],
                             wrong->written, bases[wrong_kind] + wrong->count),
                 "mend the line or write the file again");
        if (chunk.failed) fail(line_ + chunk.error_line, chunk.message, chunk.remedy, chunk.error_column);
    }

    void add_corners(const Chunk& chunk, const std::size_t (&bases)[kind_count], double left)
    {
        make_room(document_.corners, chunk.corners.size(), left);
        const std::size_t positions = document_.positions.size();
        const auto whole = [&](int index, Kind kind) {
            return is_relative(index) ? static_cast<uint>(static_cast<long>(bases[kind]) + index - relative_zero)
                                      : static_cast<uint>(index);
        };
        for (const Corner& c : chunk.corners) {
            const uvec3 key = chunk.has_relative
                                  ? uvec3(whole(c.at[kind_position], kind_position), whole(c.at[kind_uv], kind_uv),
                                          whole(c.at[kind_normal], kind_normal))
                                  : uvec3(c.at[kind_position], c.at[kind_uv], c.at[kind_normal]);
            document_.corners.push_back(table_.find_or_add(key, positions));
        }
    }

    void add_faces(const Chunk& chunk, double left)
    {
        std::vector<uint>& sizes = document_.face_sizes;
        if (chunk.has_polygons && sizes.empty()) sizes.assign(document_.face_count, 3);
        if (!sizes.empty() || chunk.has_polygons) append(sizes, chunk.face_sizes, left);
    }

    // Goes through the chunk's events and the faces between them.
    void add_events(const Chunk& chunk)
    {
        const std::size_t first_face = document_.face_count,
                          first_corner = document_.corners.size() - chunk.corners.size();
        document_.face_count += chunk.face_sizes.size();
        std::size_t face = 0, corner = 0;
        const auto add_run = [&](std::size_t end_face, std::size_t end_corner) {
            if (end_face == face) return;
            state_.first_face = first_face + face;
            state_.first_corner = first_corner + corner;
            if (document_.runs.empty() || is_changed_) document_.runs.push_back(state_);
            is_changed_ = false;
            face = end_face;
            corner = end_corner;
        };
        for (const Event& event : chunk.events) {
            add_run(event.face, event.corner);
            apply(event);
        }
        add_run(chunk.face_sizes.size(), chunk.corners.size());
    }

    void set(uint& what, uint to)
    {
        is_changed_ = is_changed_ || what != to;
        what = to;
    }

    void apply(const Event& event)
    {
        switch (event.what) {
        case Event::What::material:
            set(state_.material, materials_.number(event.name));
            break;
        case Event::What::object:
            has_objects_ = true;
            set(state_.object, objects_.number(event.name));
            break;
        case Event::What::group:
            // Groups within objects are not told apart: objects are what people see in their editor's outline.
            if (!has_objects_) set(state_.object, objects_.number(event.name));
            break;
        case Event::What::smoothing:
            set(state_.smoothing, event.smoothing);
            break;
        case Event::What::library:
            document_.libraries.push_back({event.name, line_ + event.line});
            break;
        }
    }

    std::string file_;
    Document& document_;
    CornerTable table_;
    Names objects_, materials_;
    Run state_;
    bool is_changed_ = false, has_objects_ = false;
    Chunk::Reach highest_[kind_count];
    Tally skipped_[skipped_count];
    int line_ = 1; // of the next chunk's beginning
};

// Where the last line in `text` ends that is not continued in the next one; 0 if there is none. A carriage return at
// the very end may be half a line end.
std::size_t end_of_lines(std::string_view text)
{
    for (std::size_t end = text.size(); end > 0; --end) {
        if (text[end - 1] != '\n' && (text[end - 1] != '\r' || end == text.size())) continue;
        if (text[end - 1] == '\r' && text[end] == '\n') continue;
        std::size_t before = end - 1;
        if (text[end - 1] == '\n' && before > 0 && text[before - 1] == '\r') --before;
        if (before > 0 && text[before - 1] == '\\') {
            end = before;
            continue;
        }
        return end;
    }
    return 0;
}

// Cuts whole lines into pieces for several threads.
std::vector<std::string_view> cut(std::string_view text)
{
    constexpr std::size_t piece = 1u << 19;
    std::vector<std::string_view> pieces;
    while (text.size() > piece + piece / 2) {
        const std::size_t end = end_of_lines(text.substr(0, piece));
        if (end == 0) break; // a line longer than a piece: leave the rest to one thread
        pieces.push_back(text.substr(0, end));
        text.remove_prefix(end);
    }
    if (!text.empty()) pieces.push_back(text);
    return pieces;
}

} // namespace

Document parse(ByteWindow& window, const std::function<void(double)>& progress)
{
    Document document;
    Joiner joiner(window.name(), document);
    std::uint64_t done = 0;
    for (;;) {
        // The window's last line may go on behind it.
        const std::string_view text = window.view();
        const std::size_t size = window.at_end() ? text.size() : end_of_lines(text);
        if (size > 0) {
            const std::vector<std::string_view> pieces = cut(text.substr(0, size));
            std::vector<Chunk> chunks(pieces.size());
            parallel_for(pieces.size(), [&](std::size_t i) { chunks[i] = parse_chunk(pieces[i]); });
            done += size;
            std::uint64_t left = window.most_left() - size;
            for (std::size_t i = pieces.size(); i-- > 0;) left += pieces[i].size();
            for (std::size_t i = 0; i < pieces.size(); ++i) {
                left -= pieces[i].size();
                // Packed files announce more than comes: go by how far the disk has been read.
                const double share =
                    window.is_exact() ? static_cast<double>(left) / static_cast<double>(pieces[i].size()) : 1.0;
                joiner.add(chunks[i], share);
                chunks[i] = {};
            }
            window.take(size);
        }
        if (window.disk_size() > 0)
            progress(static_cast<double>(window.disk_done()) / static_cast<double>(window.disk_size()));
        if (window.at_end()) break;
        window.more();
    }
    joiner.finish();
    return document;
}

} // namespace snell::obj
