#include "snell/view/script.h"

#include "snell/core/error.h"
#include "snell/core/text.h"
#include "snell/core/timer.h"
#include "snell/io/file.h"
#include "snell/view/app.h"
#include "snell/view/record.h"
#include "snell/view/script_input.h"
#include "snell/view/script_values.h"
#include "snell/view/viewer.h"
#include "snell/view/widgets.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

namespace snell::view {

// ---- reading ----

namespace {
struct Command
{
    const char* name;
    std::size_t least, most;          // arguments
    std::vector<std::size_t> numbers; // arguments that are numbers
    const char* usage;
};

const std::vector<Command>& commands()
{
    static const std::vector<Command> all = {
        {"open", 1, 1, {}, "open SCENE"},
        {"size", 2, 2, {0, 1}, "size WIDTH HEIGHT"},
        {"key", 1, 1, {}, "key NAME"},
        {"hold", 2, 2, {1}, "hold NAME MILLISECONDS"},
        {"type", 1, 1, {}, "type \"TEXT\""},
        {"move", 2, 2, {0, 1}, "move X Y"},
        {"click", 2, 3, {0, 1}, "click X Y [right|middle|alt]"},
        {"drag", 4, 5, {0, 1, 2, 3}, "drag X1 Y1 X2 Y2 [right|middle|alt]"},
        {"wheel", 1, 1, {0}, "wheel NOTCHES"},
        {"wait",
         1,
         3,
         {},
         "wait MILLISECONDS, wait frame|picture|scene|rest, wait spp N, or wait NAME COMPARISON VALUE"},
        {"set", 2, 2, {}, "set NAME VALUE"},
        {"panel", 2, 2, {}, "panel NAME open|close|float|dock"},
        {"press", 1, 1, {}, "press \"LABEL\""},
        {"enter", 2, 2, {}, "enter \"LABEL\" VALUE"},
        {"drop", 1, 1, {}, "drop FILE"},
        {"screenshot", 1, 2, {}, "screenshot [--window] FILE"},
        {"assert", 2, 8, {}, "assert NAME [==|!=|<|<=|>|>=] VALUE, or assert pixel X Y near R G B [TOLERANCE]"},
        {"say", 1, 1, {}, "say \"TEXT\""},
        {"record", 2, 2, {1}, "record PATTERN FRAMES"},
        {"random", 2, 2, {0, 1}, "random SECONDS SEED"},
        {"quit", 0, 0, {}, "quit"},
    };
    return all;
}

const Command* find_command(const std::string& name)
{
    for (const Command& command : commands())
        if (command.name == name) return &command;
    return nullptr;
}
} // namespace

static std::vector<std::string> split_words(const std::string& line, const Place& place)
{
    std::vector<std::string> words;
    for (std::size_t i = 0; i < line.size();) {
        if (line[i] == ' ' || line[i] == '\t' || line[i] == '\r') {
            ++i;
        } else if (line[i] == '#') {
            break;
        } else if (line[i] == '"') {
            const std::size_t end = line.find('"', i + 1);
            if (end == std::string::npos) throw Error(place, "a quote has no end", "put a \" behind the text");
            words.push_back(line.substr(i + 1, end - i - 1));
            i = end + 1;
        } else {
            const std::size_t end = std::min(line.find_first_of(" \t\r", i), line.size());
            words.push_back(line.substr(i, end - i));
            i = end;
        }
    }
    return words;
}

static void check_line(const ScriptLine& line, const std::string& file)
{
    const Place place{file, line.number, 0};
    const Command* command = find_command(line.words[0]);
    if (command == nullptr) {
        std::vector<std::string> names;
        std::string all;
        for (const Command& one : commands()) {
            names.emplace_back(one.name);
            all += (all.empty() ? "" : ", ") + std::string(one.name);
        }
        const std::string guess = nearest(line.words[0], names);
        throw Error(place, fmt::format("there is no command '{}'", line.words[0]),
                    guess.empty() ? "there are: " + all : fmt::format("did you mean '{}'?", guess));
    }
    const std::size_t count = line.words.size() - 1;
    if (count < command->least || count > command->most)
        throw Error(place, fmt::format("'{}' has {} arguments", line.words[0], count),
                    fmt::format("write it as in: {}", command->usage));
    for (const std::size_t number : command->numbers)
        if (!read_value(line.words[number + 1]))
            throw Error(place, fmt::format("'{}' is not a number", line.words[number + 1]),
                        fmt::format("write it as in: {}", command->usage));
    if ((line.words[0] == "key" || line.words[0] == "hold") && !parse_key(line.words[1]))
        throw Error(place, fmt::format("there is no key '{}'", line.words[1]),
                    "write it as in: key F1, key Ctrl+1, hold w 500");
}

std::vector<ScriptLine> parse_script(const std::string& text, const std::string& file)
{
    std::vector<ScriptLine> lines;
    int number = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        ScriptLine line;
        line.number = ++number;
        line.words = split_words(text.substr(begin, end - begin), {file, number, 0});
        begin = end + 1;
        if (line.words.empty()) continue;
        check_line(line, file);
        lines.push_back(std::move(line));
    }
    return lines;
}

Script::Script(std::filesystem::path file)
    : file_(std::move(file)), lines_(parse_script(read_file(file_), file_.string()))
{
}

void check_script(const std::filesystem::path& file)
{
    parse_script(read_file(file), file.string());
}

// ---- running ----

namespace {
struct AssertionFailed
{
    std::string why;
};
} // namespace

void Script::step(App& app)
{
    wants_frame_ = false;
    int number = next_ < lines_.size() ? lines_[next_].number : 0;
    const auto end = [&](int code, const std::string& what) {
        fmt::print(stderr, "snell: error: {}:{}: {}\n", file_.string(), number, what);
        next_ = lines_.size();
        steps_.clear();
        app.hold_open(false);
        app.quit(code);
    };
    try {
        for (;;) {
            while (!steps_.empty()) {
                Step now = std::move(steps_.front()); // which may put others before those that follow
                steps_.pop_front();
                if (now(app)) continue;
                steps_.push_front(std::move(now));
                return;
            }
            if (next_ >= lines_.size()) return;
            number = lines_[next_].number;
            run(app, lines_[next_]);
            // The line counts as under way until its steps are done: messages name it.
            const std::size_t of_line = next_;
            then([this, of_line](App&) {
                next_ = std::max(next_, of_line + 1);
                return true;
            });
        }
    } catch (const AssertionFailed& failed) {
        end(1, failed.why);
    } catch (const std::exception& error) {
        end(2, error.what());
    }
}

// An event is handled in the next turn of the loop, after the frame of this one: two frames show what it does.
void Script::then_frames(int count)
{
    then([this, count, until = std::uint64_t{0}](App& app) mutable {
        if (until == 0) until = app.frames() + static_cast<std::uint64_t>(count);
        wants_frame_ = app.frames() < until;
        return !wants_frame_;
    });
}

void Script::then_wait(const std::string& what, std::function<bool(App&)> is_so)
{
    then([what, is_so = std::move(is_so), timer = std::optional<Timer>()](App& app) mutable {
        if (!timer) timer.emplace();
        if (is_so(app)) return true;
        constexpr double patience = 60.0;
        if (app.state().status.phase == SessionStatus::Phase::failed)
            throw AssertionFailed{fmt::format("waiting for {}: {}", what, app.state().status.what)};
        if (timer->seconds() > patience) throw AssertionFailed{fmt::format("waited a minute for {}", what)};
        return false;
    });
}

void Script::then_click(float x, float y, const std::string& how)
{
    then([=](App& app) { return push_move(app, x, y); });
    then_frames(3); // controls have to see where the mouse is before they are pressed
    then([=](App& app) { return push_button(app, x, y, how, true); });
    then_frames(2);
    then([=](App& app) { return push_button(app, x, y, how, false); });
    then_frames(2);
}

void Script::then_key(const KeyName& key)
{
    then([=](App& app) { return push_key(app, key, true); });
    then_frames(2);
    then([=](App& app) { return push_key(app, key, false); });
    then_frames(2);
}

void Script::then_press(const std::string& label, const std::string& how)
{
    then([=](App&) {
        seek_item(label);
        return true;
    });
    then_frames(4); // controls that have just come, or had to be scrolled to, know their place
    then([=, this](App&) {
        const auto place = find_item(label);
        seek_item("");
        if (!place) throw Error(fmt::format("no control '{}' is to be seen", label), "open its panel first");
        // Its clicks come before what else this line has to do.
        std::deque<Step> rest;
        rest.swap(steps_);
        then_click(place->x, place->y, how);
        for (Step& step : rest) then(std::move(step));
        return true;
    });
}

void Script::then_drag(float x0, float y0, float x1, float y1, const std::string& how)
{
    then([=](App& app) { return push_move(app, x0, y0); });
    then_frames(3);
    then([=](App& app) { return push_button(app, x0, y0, how, true); });
    constexpr int steps = 10;
    for (int i = 1; i <= steps; ++i) {
        const float t = static_cast<float>(i) / steps;
        then_frames(2);
        then([=](App& app) { return push_move(app, x0 + t * (x1 - x0), y0 + t * (y1 - y0)); });
    }
    then_frames(2);
    then([=](App& app) { return push_button(app, x1, y1, how, false); });
    then_frames(2);
}

// Any input at all, for a while: what a child would do.
void Script::then_random(double seconds, uint seed)
{
    random_.seed(seed);
    then([this, seconds, timer = Timer(), frame = std::uint64_t{0}](App& app) mutable {
        app.hold_open(true);
        if (timer.seconds() > seconds) {
            app.hold_open(false);
            return true;
        }
        wants_frame_ = true;
        if (app.frames() != frame) push_random(app, random_);
        frame = app.frames();
        return false;
    });
    then([](App& app) { return release_all(app); });
}

static double of(const ScriptLine& line, std::size_t word)
{
    return *read_value(line.words[word]); // checked when it was read
}

static constexpr std::array comparisons = {"==", "!=", "<", "<=", ">", ">="};

static bool holds(double value, const std::string& comparison, double wanted)
{
    if (comparison == "<") return value < wanted;
    if (comparison == "<=") return value <= wanted;
    if (comparison == ">") return value > wanted;
    if (comparison == ">=") return value >= wanted;
    if (comparison == "!=") return value != wanted;
    return value == wanted;
}

// Of numbers, or of words that are equal or not.
static bool holds(const std::string& value, const std::string& comparison, const std::string& wanted)
{
    if (std::find(comparisons.begin(), comparisons.end(), comparison) == comparisons.end())
        throw Error(fmt::format("'{}' is no comparison", comparison), "there are ==, !=, <, <=, > and >=");
    const auto left = read_value(value), right = read_value(wanted);
    if (left && right) return holds(*left, comparison, *right);
    if (comparison == "==" || comparison == "!=") return (value == wanted) == (comparison == "==");
    if (value == "none") return false; // there is no such number yet
    throw Error(fmt::format("'{}' and '{}' are not both numbers", value, wanted), "compare words with == or !=");
}

void Script::run(App& app, const ScriptLine& line)
{
    const std::vector<std::string>& words = line.words;
    const std::string& name = words[0];
    const auto at = [&](std::size_t word) { return static_cast<float>(of(line, word)); };
    const auto how = [&](std::size_t word) { return words.size() > word ? words[word] : std::string("left"); };
    if (name == "open") {
        app.state().open(words[1]);
    } else if (name == "size") {
        app.set_size(static_cast<int>(at(1)), static_cast<int>(at(2)));
        then_frames(2);
        then([timer = Timer()](App&) { return timer.seconds() > 0.3; }); // until pictures are asked for in that size
        then_frames(1);
    } else if (name == "key") {
        then_key(*parse_key(words[1]));
    } else if (name == "hold") {
        const KeyName key = *parse_key(words[1]);
        const double seconds = 1e-3 * of(line, 2);
        then([=](App& a) { return push_key(a, key, true); });
        then([seconds, timer = std::optional<Timer>()](App&) mutable {
            if (!timer) timer.emplace();
            return timer->seconds() >= seconds;
        });
        then([=](App& a) { return push_key(a, key, false); });
        then_frames(2);
    } else if (name == "type") {
        then([text = words[1]](App& a) { return push_text(a, text); });
        then_frames(2);
    } else if (name == "move") {
        then([x = at(1), y = at(2)](App& a) { return push_move(a, x, y); });
        then_frames(2);
    } else if (name == "click") {
        then_click(at(1), at(2), how(3));
    } else if (name == "drag") {
        then_drag(at(1), at(2), at(3), at(4), how(5));
    } else if (name == "wheel") {
        then([notches = static_cast<int>(at(1))](App& a) { return push_wheel(a, notches); });
        then_frames(2);
    } else if (name == "press") {
        then_press(words[1], "left");
    } else if (name == "enter") {
        then_press(words[1], "ctrl"); // which makes a slider a field
        for (const char* key : {"Ctrl+a", "", "Return"}) {
            if (*key == '\0')
                then([text = words[2]](App& a) { return push_text(a, text); });
            else
                then_key(*parse_key(key));
            then_frames(2);
        }
    } else if (name == "drop") {
        then([file = words[1]](App& a) { return push_drop(a, file); });
        then_frames(2);
    } else if (name == "wait") {
        const std::string& what = words[1];
        if (what == "frame") {
            then_frames(1);
        } else if (what == "picture") {
            then_wait("a picture", [](App& a) {
                return a.state().opened != 0 && a.state().opened == a.state().status.opened && a.is_settled() &&
                       !a.is_opening() && a.state().panes[0].shot != nullptr && !a.state().panes[0].shot->is_preview &&
                       a.state().panes[0].shot->width == a.state().panes[0].request.settings.width &&
                       a.state().panes[0].shot->height == a.state().panes[0].request.settings.height;
            });
            then_frames(1);
        } else if (what == "scene") {
            then_wait("the scene", [](App& a) { return a.state().opened != 0 && !a.is_opening(); });
            then_frames(1);
        } else if (what == "rest") {
            then_frames(2);
            then_wait("rest", [](App& a) {
                return !a.is_opening() && a.is_settled() && a.state().status.phase == SessionStatus::Phase::resting;
            });
            then_frames(2);
        } else if (what == "spp" && words.size() == 3 && read_value(words[2])) {
            const double spp = of(line, 2);
            then_wait(fmt::format("{} samples a pixel", words[2]), [spp](App& a) {
                const ShotPtr& shot = a.state().panes[0].shot;
                return !a.is_opening() && a.is_settled() && shot != nullptr && !shot->is_preview && shot->spp >= spp;
            });
            then_frames(1);
        } else if (words.size() == 4) {
            then_wait(line.words[1] + " " + words[2] + " " + words[3],
                      [words](App& a) { return holds(get_value(a, words[1]), words[2], words[3]); });
        } else if (const auto ms = read_value(what); ms && words.size() == 2) {
            then([seconds = 1e-3 * *ms, timer = std::optional<Timer>()](App&) mutable {
                if (!timer) timer.emplace();
                return timer->seconds() >= seconds;
            });
        } else {
            throw Error(fmt::format("nothing to wait for: '{}'", what), find_command(name)->usage);
        }
    } else if (name == "set") {
        set_value(app, words[1], words[2]);
        then_frames(1);
    } else if (name == "panel") {
        Panel* panel = app.find_panel(words[1]);
        if (panel == nullptr)
            throw Error(fmt::format("there is no panel '{}'", words[1]), "the menu Panels lists them");
        panel->is_open = words[2] != "close";
        if (words[2] == "float") panel->is_floating = true;
        if (words[2] == "dock") panel->is_floating = false;
        then_frames(2);
    } else if (name == "screenshot") {
        if (words.size() == 3 && words[1] != "--window")
            throw Error(fmt::format("'{}' is no option of screenshot", words[1]), find_command(name)->usage);
        if (words.size() == 3) {
            then([file = words[2]](App& a) {
                a.window().shoot(file);
                return true;
            });
            then_frames(1);
        } else {
            app.save_screenshot(words[1]);
        }
    } else if (name == "assert") {
        check(app, line);
    } else if (name == "say") {
        app.state().say(words[1]);
        fmt::print(stderr, "snell: {}\n", words[1]);
    } else if (name == "record") {
        std::vector<CameraDesc> views;
        for (const auto& view : app.state().stored)
            if (view) views.push_back(*view);
        const auto recorder = std::make_shared<Recorder>(words[1], views, static_cast<uint>(of(line, 2)));
        then([recorder](App& a) { return recorder->step(a); });
    } else if (name == "random") {
        then_random(of(line, 1), static_cast<uint>(of(line, 2)));
    } else if (name == "quit") {
        app.hold_open(false);
        app.quit(0);
    }
}

// ---- assertions ----

static void check_pixel(const ScreenPicture& screen, const std::vector<std::string>& words, float scale)
{
    std::array<double, 6> n{};
    constexpr std::array<std::size_t, 5> at = {2, 3, 5, 6, 7};
    for (std::size_t i = 0; i < at.size(); ++i) n[i] = read_value(words[at[i]]).value_or(NAN);
    const double tolerance = words.size() > 8 ? read_value(words[8]).value_or(NAN) : 16.0;
    const int x = static_cast<int>(n[0] * scale), y = static_cast<int>(n[1] * scale);
    if (x < 0 || y < 0 || x >= screen.width || y >= screen.height)
        throw AssertionFailed{fmt::format("pixel {} {} is outside of the window", words[2], words[3])};
    const std::uint32_t texel =
        screen
            .texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(screen.width) + static_cast<std::size_t>(x)];
    for (int channel = 0; channel < 3; ++channel)
        if (!(std::abs(static_cast<double>(texel >> 8 * channel & 255u) - n[static_cast<std::size_t>(channel) + 2]) <=
              tolerance))
            throw AssertionFailed{fmt::format("pixel {} {} is {} {} {}, not near {} {} {}", words[2], words[3],
                                              texel & 255u, texel >> 8 & 255u, texel >> 16 & 255u, words[5], words[6],
                                              words[7])};
}

void Script::check(App& app, const ScriptLine& line)
{
    const std::vector<std::string>& words = line.words;
    if (words[1] == "pixel") {
        if (words.size() < 8 || words[4] != "near")
            throw Error("an assertion about a pixel lacks something", "write: assert pixel X Y near R G B [TOLERANCE]");
        const auto screen = std::make_shared<ScreenPicture>();
        app.window().inspect([screen](const ScreenPicture& picture) { *screen = picture; });
        then_frames(1);
        then([screen, words](App& a) {
            check_pixel(*screen, words, a.window().pixels_per_unit());
            return true;
        });
        return;
    }
    if (words.size() > 4) throw Error("the assertion is not understood", find_command("assert")->usage);
    const std::string comparison = words.size() == 4 ? words[2] : "==", wanted = words.back();
    const std::string value = get_value(app, words[1]);
    if (!holds(value, comparison, wanted))
        throw AssertionFailed{fmt::format("{} {} {} does not hold: it is {}", words[1], comparison, wanted, value)};
}

} // namespace snell::view
