# plot_outline.gp - outlines over the axes x and y in one frame, told apart by colours, and by dashes and marks.
left = 118
width = wide(560, 1, left + legend_room)

eval column_page
height = high(500.0*width/560, 1, top + 84)
page_height = top + height + 84
load 'page.gp'
eval x_label(left + 0.5*width, top + height + 46)
eval y_label(axis_label('y', height + 28), 22, top + 0.5*height)
eval column_legend
load 'panels.gp'

eval panel(left, top, width, height)
eval grid
eval axis_tics('x', width/65, 1)
eval axis_tics('y', height/45, 1)
if (cross) {
    set label 1 '' at 0,0 point pt 1 ps 1.4 lw 2 lc rgb 'black' front
}
allowed_dash(k) = alloweds > 1 ? legend_dash[k] : 11
plot for [k=1:outlines] '$outline'.k using 1:2 with linespoints lw 2.2 dt legend_dash[k] lc rgb legend_colour[k] \
    pt (legend_point[k] > 0 ? legend_point[k] : -1) pn 12 ps 1.1 notitle, \
    for [k=1:alloweds] '$allowed'.k using 1:2 with lines lw (alloweds > 1 ? 0.8 : 2) dt allowed_dash(k) \
    lc rgb (alloweds > 1 ? legend_colour[k] : colour_allowed) notitle
