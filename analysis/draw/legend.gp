# legend.gp - what the legend takes of the page: beside the panels legend_width px, or below them, where an asked
# width has no room for that, legend_height px. `bars`: it has a colour bar, too.
legend_below = legend_low || table_columns > 0 || asked_width > 0 && asked_width < 760
# Dashes are told apart from some length on.
legend_indent = 22
do for [k=1:legends] { if (legend_dash[k] > 0) { legend_indent = 52 } }
entry_width(k) = legend_indent + 8.2*strlen(legend_text[k])
array entry_x[40]
array entry_y[40]
legend_width = bars ? 112 : 0
f_x = 0
f_y = 0
if (legend_head ne '') {
    legend_head = wrap(legend_head, letters((legend_below && asked_width > 0 ? asked_width : 300) - 2*margin, 11))
    f_y = 6 + 16*lines(legend_head)
    legend_width = 7.6*longest_line(legend_head)
}
do for [k=1:legends] {
    if (legend_below && f_x > 0 && f_x + entry_width(k) > (asked_width > 0 ? asked_width : 1120) - 2*margin) { f_x = 0; f_y = f_y + legend_step }
    entry_x[k] = f_x
    entry_y[k] = f_y
    about_height = 14*(lines(legend_about[k]) - 1)
    if (legend_below && about_height == 0 && !table_columns) { f_x = f_x + entry_width(k) + 20 } else { f_y = f_y + legend_step + about_height; f_x = 0 }
    legend_width = at_least(legend_width, at_least(entry_width(k), legend_indent + 6.4*longest_line(legend_about[k])))
}
if (f_x > 0) { f_y = f_y + legend_step }
do for [k=1:notes] {
    note[k] = wrap(note[k], letters((legend_below && asked_width > 0 ? asked_width : 320) - 2*margin, 11))
    legend_width = legend_width > 7.6*longest_line(note[k]) ? legend_width : 7.6*longest_line(note[k])
}
notes_y = f_y
do for [k=1:notes] { f_y = f_y + 17*lines(note[k]) }
legend_tall = f_y
bar_y = at_least(70, f_y + 14)
legend_height = legend_below ? f_y + (bars ? 90 : 0) + 8 + table_top : 0
# What it takes of the width, its margins included; below, half a label of a tic at the right end is beyond the panel.
legend_room = legend_below ? margin + 10 : 20 + legend_width + margin
