# plot_phase.gp - panels side by side, each with axes of its own.
columns = at_most(panels, asked_width > 0 ? at_least(1, int(asked_width/230)) : panels < 5 ? panels : 3)
columns = panels == 4 && columns > 2 ? 2 : columns
rows = (panels + columns - 1)/columns
beside = 76
below = 62
left = beside
panel_width = wide(columns < 3 ? 330 : 270, columns, columns*beside + legend_room)
width = columns*panel_width + (columns - 1)*beside
eval column_page
panel_height = high(0.9*panel_width, rows, top + rows*below)
across(p) = left + (p - 1) % columns*(panel_width + beside)
down(p) = top + (p - 1)/columns*(panel_height + below)
page_height = down(1 + (rows - 1)*columns) + panel_height + below
load 'page.gp'
do for [p=1:panels] {
    eval y_label(axis_label('y'.p, panel_height), across(p) - 56, down(p) + 0.5*panel_height)
    set label axis_label('x'.p, panel_width + 40) at screen X(across(p) + 0.5*panel_width), Y(down(p) + panel_height + 42) \
        center @small front
}
eval column_legend
load 'panels.gp'

eval grid
do for [p=1:panels] {
    eval panel(across(p), down(p), panel_width, panel_height)
    eval axis_tics('x'.p, panel_width/56, 1)
    eval axis_tics('y'.p, panel_height/36, 1)
    eval 'plot '.panel_plot[p][3:*]
}
