// The panels there are, in the order of the column and the menu. To add one: its file in panels/, a declaration and a
// line here.
#include "snell/view/panel.h"

namespace snell::view {

std::unique_ptr<Panel> make_scene_tree_panel();
std::unique_ptr<Panel> make_inspector_panel();
std::unique_ptr<Panel> make_timeline_panel();
std::unique_ptr<Panel> make_settings_panel();
std::unique_ptr<Panel> make_view_settings_panel();
std::unique_ptr<Panel> make_camera_lab_panel();
std::unique_ptr<Panel> make_views_panel();
std::unique_ptr<Panel> make_probe_panel();
std::unique_ptr<Panel> make_paths_panel();
std::unique_ptr<Panel> make_bvh_panel();
std::unique_ptr<Panel> make_compare_panel();
std::unique_ptr<Panel> make_numbers_panel();
std::unique_ptr<Panel> make_convergence_panel();
std::unique_ptr<Panel> make_messages_panel();
std::unique_ptr<Panel> make_help_panel();

std::vector<std::unique_ptr<Panel>> make_panels()
{
    std::vector<std::unique_ptr<Panel>> panels;
    panels.push_back(make_settings_panel());
    panels.push_back(make_scene_tree_panel());
    panels.push_back(make_inspector_panel());
    panels.push_back(make_timeline_panel());
    panels.push_back(make_view_settings_panel());
    panels.push_back(make_camera_lab_panel());
    panels.push_back(make_views_panel());
    panels.push_back(make_probe_panel());
    panels.push_back(make_paths_panel());
    panels.push_back(make_bvh_panel());
    panels.push_back(make_compare_panel());
    panels.push_back(make_numbers_panel());
    panels.push_back(make_convergence_panel());
    panels.push_back(make_messages_panel());
    panels.push_back(make_help_panel());
    return panels;
}

} // namespace snell::view
