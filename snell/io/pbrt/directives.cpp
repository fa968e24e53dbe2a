// The directives of a pbrt file, one after the other.
#include "snell/io/file.h"
#include "snell/io/gzip.h"
#include "snell/io/pbrt/loader.h"
#include "snell/io/text_cursor.h"
#include "snell/io/text_encoding.h"

#include <cmath>

namespace snell::pbrt {
namespace {

constexpr std::size_t most_nested = 10'000;   // AttributeBegin within each other
constexpr std::size_t most_includes = 32;     // files within each other
constexpr std::size_t most_defaults = 100;    // parameters of Attribute
constexpr std::size_t most_included = 10'000; // files in all
constexpr std::size_t always_bytes = 64 << 20;

// Files may be included again, but what all of them bring must stay in proportion to what they are: files that include
// each other twice are as long as 2^depth.
struct Included
{
    std::map<std::string, std::size_t> sizes;
    std::size_t distinct = 0, total = 0, count = 0, depth = 0;
};

class Reader
{
  public:
    Reader(Loader& loader, Included& included) : loader_(loader), included_(included) {}

    void file(const std::filesystem::path& path, const Spot& from);

  private:
    enum class Block
    {
        attribute,
        transform,
        object
    };

    void directives(Tokenizer& tokens);
    bool transform_directive(const Token& token, Tokenizer& tokens);
    bool block_directive(const Token& token, Tokenizer& tokens);
    bool typed_directive(const Token& token, Tokenizer& tokens);
    bool state_directive(const Token& token, Tokenizer& tokens);
    void unknown(const Token& token, Tokenizer& tokens);

    void push(Block block, const Spot& spot);
    void pop(Block block, const Token& token);
    void begin_object(const std::string& name, const Spot& spot);
    void place_object(const std::string& name, const Spot& spot);
    void attribute(const std::string& target, const ParameterList& parameters);
    void medium_interface(Tokenizer& tokens, const Spot& spot);
    void apply(const Matrix& m);

    template <std::size_t n>
    std::array<double, n> numbers(Tokenizer& tokens, const Token& directive);
    std::string string(Tokenizer& tokens, const Token& directive);
    ParameterList parameters(Tokenizer& tokens, const Spot& spot, std::string_view target);
    uint medium(const std::string& name, const Spot& spot);

    Loader& loader_;
    Included& included_;
    std::vector<std::pair<Block, GraphicsState>> stack_;
};

[[noreturn]] void fail(const Token& token, std::string_view wanted, std::string_view directive)
{
    const bool is_end = token.kind == Token::Kind::end;
    throw Error(token.spot.place(),
                fmt::format("{} should be here, for {}, but there is {}", wanted, directive,
                            is_end ? "the end of the file" : show_word(token.text)),
                is_end ? "the file is truncated: get or write it again" : "mend the directive");
}

double to_number(const Token& token, std::string_view directive)
{
    double value = 0;
    std::string_view text = token.text;
    if (text.starts_with('+')) text.remove_prefix(1);
    const char* const end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value);
    if (token.kind != Token::Kind::word || result.ptr != end ||
        (result.ec != std::errc() && result.ec != std::errc::result_out_of_range))
        fail(token, "a number", directive);
    if (result.ec == std::errc::result_out_of_range) value = text.find("e-") != text.npos ? 0.0 : HUGE_VAL;
    if (!(std::abs(value) <= 1e18)) fail(token, "a number of at most 1e18", directive);
    return value;
}

template <std::size_t n>
std::array<double, n> Reader::numbers(Tokenizer& tokens, const Token& directive)
{
    std::array<double, n> values{};
    const bool has_brackets = tokens.peek().kind == Token::Kind::open;
    if (has_brackets) tokens.next();
    for (double& value : values) value = to_number(tokens.next(), directive.text);
    if (has_brackets)
        if (const Token close = tokens.next(); close.kind != Token::Kind::close) fail(close, "']'", directive.text);
    return values;
}

std::string Reader::string(Tokenizer& tokens, const Token& directive)
{
    const Token token = tokens.next();
    if (token.kind != Token::Kind::string) fail(token, "a string in quotes", directive.text);
    return unescape(token.text);
}

ParameterList Reader::parameters(Tokenizer& tokens, const Spot& spot, std::string_view target)
{
    ParameterList list = ParameterList::read(tokens, spot, loader_.notes);
    if (const auto defaults = loader_.state.defaults.find(target); defaults != loader_.state.defaults.end())
        list.append_missing(*defaults->second);
    return list;
}

void Reader::file(const std::filesystem::path& path, const Spot& from)
{
    const std::string name = path.string();
    if (included_.depth >= most_includes)
        throw Error(from.place(), fmt::format("files are included within each other more than {} deep", most_includes),
                    "does a file include itself?");
    std::error_code error;
    if (from.file != nullptr && !std::filesystem::exists(path, error))
        throw Error(from.place(), fmt::format("the file to include, {}, is not there", name), "check the path");
    std::string bytes = read_file(path);
    if (is_gzip(bytes)) bytes = gunzip(name, bytes);
    const std::string text = to_utf8(std::move(bytes));
    const auto [known, is_new] = included_.sizes.emplace(name, text.size());
    if (is_new) included_.distinct += text.size();
    included_.total += text.size();
    if (++included_.count > most_included || included_.total > always_bytes + 100 * included_.distinct)
        throw Error(from.place(), "files are included too often", "make an object of what is needed many times");
    if (included_.depth == 0)
        loader_.is_v3 = text.find("WorldEnd") != text.npos || text.find("Film \"image\"") != text.npos;

    ++included_.depth;
    const std::filesystem::path before = loader_.folder;
    if (from.file != nullptr) loader_.folder = path.parent_path();
    const std::size_t depth = stack_.size();
    Tokenizer tokens(known->first, text); // the map keeps the name where it is
    directives(tokens);
    if (stack_.size() > depth && included_.depth == 1) {
        loader_.warn(tokens.next().spot, "unfinished", "a block that was begun is not ended");
        loader_.object = {};
    }
    loader_.folder = before;
    --included_.depth;
}

void Reader::directives(Tokenizer& tokens)
{
    for (;;) {
        const Token token = tokens.next();
        if (token.kind == Token::Kind::end) return;
        if (token.kind != Token::Kind::word)
            throw Error(token.spot.place(),
                        fmt::format("a directive should be here, but there is {}", show_word(token.text)),
                        "check what is before it");
        if (transform_directive(token, tokens) || typed_directive(token, tokens) || block_directive(token, tokens) ||
            state_directive(token, tokens))
            continue;
        unknown(token, tokens);
    }
}

void Reader::apply(const Matrix& m)
{
    for (std::size_t i = 0; i < 2; ++i)
        if ((loader_.state.active >> i & 1u) != 0) loader_.state.ctm[i] = loader_.state.ctm[i] * m;
}

bool Reader::transform_directive(const Token& token, Tokenizer& tokens)
{
    const std::string_view word = token.text;
    std::array<Matrix, 2>& ctm = loader_.state.ctm;
    const auto set = [&](const Matrix& m) {
        for (std::size_t i = 0; i < 2; ++i)
            if ((loader_.state.active >> i & 1u) != 0) ctm[i] = m;
    };
    if (word == "Identity") {
        set(Matrix(1.0));
    } else if (word == "Translate") {
        const auto n = numbers<3>(tokens, token);
        apply(translate({n[0], n[1], n[2]}));
    } else if (word == "Scale") {
        const auto n = numbers<3>(tokens, token);
        apply(scale({n[0], n[1], n[2]}));
    } else if (word == "Rotate") {
        const auto n = numbers<4>(tokens, token);
        apply(rotate(n[0], {n[1], n[2], n[3]}));
    } else if (word == "LookAt") {
        const auto n = numbers<9>(tokens, token);
        const auto m = look_at({n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]});
        if (!m)
            throw Error(token.spot.place(),
                        "this LookAt has no direction: eye and target are one, or up is along the view",
                        "give it others");
        apply(*m);
        loader_.look = Look{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}};
    } else if (word == "Transform" || word == "ConcatTransform") {
        const auto n = numbers<16>(tokens, token);
        Matrix m;
        for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = n[static_cast<std::size_t>(i)];
        if (word == "Transform")
            set(m);
        else
            apply(m);
    } else if (word == "CoordinateSystem") {
        const std::string name = string(tokens, token);
        if (name.starts_with(camera_mark)) loader_.camera_name = name.substr(camera_mark.size());
        loader_.coordinate_systems[name] = ctm;
    } else if (word == "CoordSysTransform") {
        const std::string name = string(tokens, token);
        const auto known = loader_.coordinate_systems.find(name);
        if (known != loader_.coordinate_systems.end())
            ctm = known->second;
        else
            loader_.warn(
                token.spot, "coordinates " + name,
                fmt::format("the coordinate system {} is not defined; the directive is ignored", show_word(name)));
    } else if (word == "ActiveTransform") {
        const Token which = tokens.next();
        if (which.text == "StartTime")
            loader_.state.active = 1;
        else if (which.text == "EndTime")
            loader_.state.active = 2;
        else if (which.text == "All")
            loader_.state.active = 3;
        else
            fail(which, "StartTime, EndTime or All", word);
    } else if (word == "TransformTimes") {
        numbers<2>(tokens, token);
    } else {
        return false;
    }
    return true;
}

void Reader::push(Block block, const Spot& spot)
{
    if (stack_.size() >= most_nested)
        throw Error(spot.place(), fmt::format("blocks are nested more than {} deep", most_nested), "end some first");
    stack_.emplace_back(block, loader_.state);
}

void Reader::pop(Block block, const Token& token)
{
    if (stack_.empty() || stack_.back().first != block)
        throw Error(token.spot.place(), fmt::format("{} ends nothing that was begun", token.text),
                    "each Begin has one End of its kind");
    GraphicsState& saved = stack_.back().second;
    if (block == Block::transform)
        loader_.state.ctm = saved.ctm, loader_.state.active = saved.active;
    else
        loader_.state = std::move(saved);
    stack_.pop_back();
}

bool Reader::block_directive(const Token& token, Tokenizer& tokens)
{
    const std::string_view word = token.text;
    const Spot spot = token.spot;
    if (word == "AttributeBegin")
        push(Block::attribute, spot);
    else if (word == "AttributeEnd")
        pop(Block::attribute, token);
    else if (word == "TransformBegin")
        push(Block::transform, spot);
    else if (word == "TransformEnd")
        pop(Block::transform, token);
    else if (word == "ObjectBegin")
        begin_object(string(tokens, token), spot);
    else if (word == "ObjectEnd") {
        pop(Block::object, token);
        loader_.object = {};
    } else if (word == "ObjectInstance")
        place_object(string(tokens, token), spot);
    else if (word == "WorldBegin") {
        if (loader_.in_world) loader_.warn(spot, "second world", "a second WorldBegin is ignored");
        loader_.in_world = true;
        loader_.state.ctm = {Matrix(1.0), Matrix(1.0)};
        loader_.state.active = 3;
        loader_.coordinate_systems["world"] = loader_.state.ctm;
    } else if (word == "WorldEnd") {
        if (tokens.peek().kind != Token::Kind::end)
            loader_.inform(spot, "after WorldEnd", "what follows WorldEnd is read as if it stood before");
    } else if (word == "Include" || word == "Import") {
        const std::string name = string(tokens, token);
        const GraphicsState before = loader_.state;
        file(loader_.resolve(name, spot), spot);
        if (word == "Import") loader_.state = before; // what it sets stays its own
    } else {
        return false;
    }
    return true;
}

void Reader::begin_object(const std::string& name, const Spot& spot)
{
    if (loader_.object.valid())
        throw Error(spot.place(), "an object begins within another one", "end the first one before");
    push(Block::object, spot);
    Index<Group>& group = loader_.objects[name];
    if (!group.valid() || !loader_.scene.groups[group.value].meshes.empty() ||
        !loader_.scene.groups[group.value].spheres.empty()) {
        Group fresh;
        fresh.name = name;
        group = add(loader_.scene, fresh);
    }
    loader_.object = group;
    loader_.object_name = name;
}

void Reader::place_object(const std::string& name, const Spot& spot)
{
    if (loader_.object.valid())
        throw Error(spot.place(), fmt::format("an instance of {} within an object", show_word(name)),
                    "objects cannot contain others; place both in the world");
    Index<Group>& group = loader_.objects[name];
    if (!group.valid()) {
        Group to_come;
        to_come.name = name;
        group = add(loader_.scene, to_come);
    }
    if (!invert(loader_.ctm())) {
        loader_.warn(spot, "singular", "the transform here has no inverse; what it places is left out");
        return;
    }
    InstanceDesc instance;
    ParameterList given; // ours: the name, as a shape's
    const auto defaults = loader_.state.defaults.find("shape");
    if (defaults != loader_.state.defaults.end()) given.append_missing(*defaults->second);
    instance.name = given.text("instance", name);
    instance.group = group;
    instance.transform = to_transform(loader_.ctm());
    add(loader_.scene, instance);
}

bool Reader::typed_directive(const Token& token, Tokenizer& tokens)
{
    using Do = void (*)(Loader&, const std::string&, const ParameterList&);
    struct Entry
    {
        std::string_view directive, target; // of Attribute
        Do act;
    };
    static constexpr Entry all[] = {
        {"Shape", "shape", add_shape},
        {"Material", "material",
         [](Loader& l, const std::string& type, const ParameterList& p) {
             auto entry = std::make_shared<MaterialEntry>();
             entry->desc.name = fmt::format("{} {}", type.substr(0, 40), p.spot.line);
             make_material(l, *entry, type, p);
             l.state.material = entry;
         }},
        {"LightSource", "light", add_light},
        {"AreaLightSource", "light", set_area_light},
        {"Camera", "", set_camera},
        {"Film", "", set_film},
        {"Sampler", "", set_sampler},
        {"Integrator", "", set_integrator},
        {"SurfaceIntegrator", "", set_integrator},
        {"PixelFilter", "", set_filter},
        {"Accelerator", "", set_accelerator},
    };
    for (const Entry& entry : all) {
        if (token.text != entry.directive) continue;
        const std::string type = string(tokens, token);
        entry.act(loader_, type, parameters(tokens, token.spot, entry.target));
        return true;
    }
    return false;
}

void Reader::attribute(const std::string& target, const ParameterList& parameters)
{
    if (target != "shape" && target != "light" && target != "material" && target != "medium" && target != "texture") {
        loader_.warn(parameters.spot, "attribute " + target,
                     fmt::format("there are no attributes of {}; they are ignored", show_word(target)));
        return;
    }
    auto all = std::make_shared<std::vector<Parameter>>();
    if (const auto before = loader_.state.defaults.find(target); before != loader_.state.defaults.end())
        *all = *before->second;
    for (const Parameter& parameter : parameters.all()) {
        std::erase_if(*all, [&](const Parameter& old) { return old.name == parameter.name; });
        if (all->size() >= most_defaults || parameter.numbers.size() + parameter.integers.size() > most_defaults)
            throw Error(parameter.spot.place(), "too much for attributes",
                        "give shapes and materials their parameters where they are made");
        all->push_back(parameter);
    }
    loader_.state.defaults[target] = std::move(all);
}

uint Reader::medium(const std::string& name, const Spot& spot)
{
    if (name.empty()) return none;
    const auto known = loader_.medium_names.find(name);
    if (known != loader_.medium_names.end()) return known->second;
    loader_.warn(spot, "medium " + name,
                 fmt::format("the medium {} is not defined yet; there is none here", show_word(name)));
    return none;
}

void Reader::medium_interface(Tokenizer& tokens, const Spot& spot)
{
    const Token first = tokens.next();
    if (first.kind != Token::Kind::string) fail(first, "the name of a medium", "MediumInterface");
    loader_.state.inside = loader_.state.outside = medium(unescape(first.text), spot);
    if (tokens.peek().kind == Token::Kind::string) loader_.state.outside = medium(unescape(tokens.next().text), spot);
    const uint outside = loader_.state.outside;
    if (outside != none && loader_.media[outside].scatters)
        loader_.warn(spot, "fog",
                     fmt::format("the medium {} around the scene is left out: light crosses it unchanged",
                                 show_word(loader_.media[outside].name)));
}

bool Reader::state_directive(const Token& token, Tokenizer& tokens)
{
    const std::string_view word = token.text;
    const Spot spot = token.spot;
    if (word == "ReverseOrientation") {
        loader_.state.reverse_orientation = !loader_.state.reverse_orientation;
    } else if (word == "NamedMaterial") {
        loader_.state.material = named_material(loader_, string(tokens, token));
    } else if (word == "MakeNamedMaterial") {
        const std::string name = string(tokens, token);
        const ParameterList list = parameters(tokens, spot, "material");
        std::shared_ptr<MaterialEntry>& entry = loader_.materials[name];
        const bool is_awaited = entry && !entry->is_defined;
        if (!is_awaited) entry = std::make_shared<MaterialEntry>();
        entry->is_defined = true;
        entry->desc.name = name;
        // A mix may name the one it is about to define, so the entry is there before.
        const std::shared_ptr<MaterialEntry> keep = entry;
        make_material(loader_, *keep, list.text("type", "diffuse"), list);
        if (is_awaited) update_uses(loader_, *keep);
    } else if (word == "Texture") {
        const std::string name = string(tokens, token), value = string(tokens, token), type = string(tokens, token);
        add_texture(loader_, name, value, type, parameters(tokens, spot, "texture"));
    } else if (word == "MakeNamedMedium") {
        const std::string name = string(tokens, token);
        add_medium(loader_, name, parameters(tokens, spot, "medium"));
    } else if (word == "MediumInterface") {
        medium_interface(tokens, spot);
    } else if (word == "Attribute") {
        const std::string target = string(tokens, token);
        attribute(target, ParameterList::read(tokens, spot, loader_.notes));
    } else if (word == "ColorSpace") {
        const std::string name = string(tokens, token);
        if (const ColorSpace* space = find_color_space(name))
            loader_.state.space = space;
        else
            loader_.warn(spot, "space " + name,
                         fmt::format("the colour space {} is unknown; srgb is used", show_word(name)));
    } else if (word == "Option") {
        set_option(loader_, ParameterList::read(tokens, spot, loader_.notes));
    } else if (word == "Volume" || word == "VolumeIntegrator" || word == "Renderer") {
        string(tokens, token);
        ParameterList::read(tokens, spot, loader_.notes);
        loader_.warn(spot, std::string(word), fmt::format("{} is of an older pbrt; it is ignored", word));
    } else {
        return false;
    }
    return true;
}

void Reader::unknown(const Token& token, Tokenizer& tokens)
{
    // A file in which even the first word says nothing is of another format.
    if (token.text.empty() || std::isalpha(static_cast<unsigned char>(token.text.front())) == 0)
        throw Error(token.spot.place(),
                    fmt::format("a directive should be here, but there is {}", show_word(token.text)),
                    "check what is before it");
    loader_.warn(token.spot, "directive " + std::string(token.text.substr(0, 60)),
                 fmt::format("the directive {} is unknown; it is ignored", show_word(token.text)));
    // Its arguments go up to the next word that begins with a capital letter.
    for (;;) {
        const Token& next = tokens.peek();
        if (next.kind == Token::Kind::end) return;
        if (next.kind == Token::Kind::word && !next.text.empty() && next.text.front() >= 'A' &&
            next.text.front() <= 'Z')
            return;
        tokens.next();
    }
}

} // namespace

void read_file_into(Loader& loader, const std::filesystem::path& file, const Spot& from)
{
    // The names of files stay for as long as places refer to them.
    loader.included = std::make_shared<Included>();
    Reader(loader, *std::static_pointer_cast<Included>(loader.included)).file(file, from);
}

} // namespace snell::pbrt
