# plot_map.gp - a map in each panel, over the axes x and y: what became of every case, or the numbers of
# one answer (measured), lowest ... highest.
gap = 28
head = panels > 1 ? 22 : 0

# Two axes of panels make a table (so many across, 0: none); else the page is a little wider than it is
# high, and full where it can be.
columns = panels == 3 ? 3 : int(ceil(sqrt(1.2*panels)))
if (columns > 2 && panels % columns && panels % (columns - 1) == 0) { columns = columns - 1 }
if (table >= 1 && table <= 6) { columns = table }
if (columns > panels) { columns = panels }
rows = (panels + columns - 1) / columns
width = panels == 1 ? 560 : panels <= 4 ? 336 : 235
height = panels == 1 ? 500 : panels <= 4 ? 300 : 210

# Words beside the panels take more room than numbers.
longest = 6
if (y_scale eq 'list') { do for [k=1:y_words] { longest = strlen(y_word[k]) > longest ? strlen(y_word[k]) : longest } }
left = 118 + 9*((longest < 24 ? longest : 24) - 6)
panel_left(p) = left + (p - 1) % columns*(width + gap)
panel_top(p) = top + (p - 1)/columns*(height + 34) + head

page_width = left + columns*(width + gap) + 190
top = title_height(0)
bottom = panel_top(panels) + height
page_height = bottom + 84
load 'page.gp'

set label axis_label('x', columns*(width + gap) + 50) at screen X(left + 0.5*(columns*(width + gap) - gap)), Y(bottom + 46) \
    center @small front
# Long names may go on beside the labels under the map, but not into the title.
set label axis_label('y', bottom - top + 28) at screen X(22), Y(0.5*(top + bottom) + 14) center rotate by 90 @small front

# The longest names for which the titles of all panels have room: letters take 7 px on average.
fits_long = 1
fits_short = 1
do for [p=1:panels] {
    fits_long = fits_long && 7*strlen(title_long[p]) < width + 14
    fits_short = fits_short && 7*strlen(title_short[p]) < width + 14
}
do for [p=1:panels] {
    set label fits_long ? title_long[p] : fits_short ? title_short[p] : title_bare[p] \
        at screen X(panel_left(p) + 0.5*width), Y(panel_top(p) - 11) center @tiny front
}
legend_x = left + columns*(width + gap) + 8
legend_y = top + head + 10
if (cross) {
    line = legend_y + legends*legend_step
    set label '' at screen X(legend_x + 7), Y(line) point pt 1 ps 1.4 lw 2 lc rgb 'black' front
    set label 'equilibrium' at screen X(legend_x + 22), Y(line) left font ',12' front
}
load 'panels.gp'

eval cells_of('x')
eval cells_of('y')
if (measured) {
    if (!(highest > lowest)) { lowest = lowest - 0.5; highest = lowest + 1 } # a range of nothing cannot be drawn
    eval palette
    set cbrange [lowest:highest]
    set cbtics round_step(lowest, highest, 6) nomirror out scale 0
    set cblabel with_unit(measure, measure_unit) offset 0.5,0
    eval colour_bar(legend_x, legend_y + 70, 18, 180)
    set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor rgb no_number fillstyle solid noborder
}
cell_colour(code) = kind_colour[code+1]
if (cross) {
    set label 1 '' at cross_x,cross_y point pt 1 ps 1.6 lw 4.5 lc rgb 'white' front
    set label 2 '' at cross_x,cross_y point pt 1 ps 1.4 lw 2 lc rgb 'black' front
}
do for [p=1:panels] {
    eval panel(panel_left(p), panel_top(p), width, height)
    eval axis_tics('x', width/65, p + columns > panels)
    eval axis_tics('y', height/40, (p - 1) % columns == 0)
    if (measured) { plot @cells @as_numbers notitle } else { plot @cells @as_colours notitle }
    unset colorbox # one for all
}
