# chart.gp - a chart: panels in a grid, `columns` across, with axes x under and y beside all of them or axes of their
# own; the first `leads` panels stand above the grid, one to a row. A panel without an axis y is a strip. Series are drawn
# in the order in which the data have them.

# ---- what the legend takes of the page: beside the panels legend_width px, or below them, where an asked width has no
# room for that, legend_height px. `bars`: it has a colour bar, too ----
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

# ---- where panels stand ----
columns = at_most(columns, panels - leads)
own_x = 0; own_y = 0; logs = 0; headed = 0; asides = 0
do for [p=1:panels] {
    own_x = own_x || panel_x[p] ne 'x'
    own_y = own_y || (p > leads && panel_y[p] ne 'y' && panel_y[p] ne '')
    logs = logs || panel_y[p] ne '' && value(panel_y[p].'_scale') eq 'log'
    headed = headed || panel_heading[p] ne '' || panel_right[p] ne ''
    asides = asides || panel_aside[p] ne ''
}
wide_tics = logs && columns > 1 ? 1 : 0
# Words beside the panels take more room than numbers.
longest = 6
if (shared_y ne '' && value('y_scale') eq 'list') { do for [k=1:y_words] { longest = at_least(longest, strlen(y_word[k])) } }
labelled_y = own_y || shared_y eq '' || axis_label('y', 999) ne ''
left = plain ? 24 : (own_y && columns > 1 ? 82 : 104) + 24*wide_tics + 8.2*(longest - 6) - (labelled_y ? 0 : 22)
across = own_y ? 82 + 24*wide_tics : own_x ? 40 : asked_width > 0 ? 16 : 28 # between columns
head = headed ? 22 : 0
row_head = asides ? 44 : 0
right_room = at_least(legend_room, ends > 0 ? 24 + 7.4*longest_end : 0)
beside = leads ? margin : row_head + right_room
if (asked_width > 0 && !asides) { columns = at_most(columns, at_least(1, int((asked_width - left - beside + across)/(130 + across)))) }
width = wide(chart_width, columns, left + (columns - 1)*across + beside)
if (equal) { width = at_most(width, chart_width) }
lead_width = wide(lead_width, 1, left + legend_room)
eval chart_fit
rows = leads + (panels - leads + columns - 1)/columns
row_of(p) = p <= leads ? p : leads + 1 + (p - leads - 1)/columns
column_of(p) = p <= leads ? 0 : (p - leads - 1) % columns
panel_left(p) = left + column_of(p)*(width + across)
panel_wide(p) = p <= leads ? lead_width : width
right = left + columns*(width + across) - across
low_foot(r) = plain ? 6 : r <= leads ? 84 : own_x ? 66 : columns > 1 ? 12 : headed ? 2 : 14 # under a row that is not the last
foot = plain ? 10 : !own_x && axis_label('x', 999) eq value('x_path') || own_x && columns > 1 ? 62 : 84

page_width = at_least(table_columns ? at_least(asked_width, 2*margin + table_names + 152*table_columns) : leads ? left + lead_width + legend_room : 0, right + beside)
page_width = at_least(asked_width > 0 ? asked_width : equal ? 560 : 0, page_width)
top = title_height(0) + (stretches > 0 ? 22 : 0)
# Of a table's lines the name stands once where there is no room for it beside each value.
panel_room(p) = (columns > 1 ? width + 4 : width + legend_room) - 7*strlen(panel_right[p])
form = (sum [p=1:panels] (7*strlen(panel_heading[p]) > panel_room(p))) > 0 ? 2 : 1
short_fits(p) = panel_heading[p] eq '' || panel_short[p] ne '' && 7*strlen(panel_short[p]) <= panel_room(p)
if (form == 2 && (sum [p=1:panels] short_fits(p)) < panels) { form = 3 }
heading(p) = form == 1 ? panel_heading[p] : form == 2 ? panel_short[p] : panel_bare[p] ne '' ? panel_bare[p] \
    : columns > 1 ? end_of(panel_heading[p], panel_room(p)/7.1) : cut(panel_heading[p], panel_room(p)/7.1)
if (form > 1 && column_name ne '') { top = top + 18 }
array row_high[rows]; array row_top[rows]
own_sum = 0; other_sum = 0
do for [p=panels:1:-1] { row_high[row_of(p)] = panel_own[p]*(scaled ? 1.0*panel_wide(p)/(p <= leads ? lead_own : chart_width) : 1) }
do for [r=1:rows] {
    row_top[r] = other_sum + head
    own_sum = own_sum + row_high[r]
    other_sum = other_sum + head + (r < rows ? low_foot(r) : foot)
}
stretch = asked_height > 0 && !equal ? at_least(50.0*rows, asked_height - legend_height - top - other_sum)/own_sum : 1.0
own_sum = 0
do for [r=1:rows] {
    row_top[r] = top + row_top[r] + stretch*own_sum
    own_sum = own_sum + row_high[r]
    row_high[r] = stretch*row_high[r]
}
do for [p=1:panels] { panel_top[p] = row_top[row_of(p)]; panel_high[p] = row_high[row_of(p)] }
bottom = row_top[rows] + row_high[rows]
page_height = at_least(bottom + foot, legend_below || asked_height > 0 ? 0 : row_top[1] + legend_tall + 24)

# ---- the page, of page_width x page_height px, with title and subtitle, and the legend below the panels where it stands
# there. A px is px_points pt of a page of an asked size and of PDF, px_dots dots of a PNG ----
needed(px) = int(px*px_points/72*25.4 + 0.999)
if ((asked_width > 0 && page_width > asked_width + 1) || (asked_height > 0 && page_height + legend_height > asked_height + 1)) {
    print sprintf('the picture needs %d x %d mm with text of this size', needed(page_width), needed(page_height + legend_height))
    exit status 3
}
legend_floor = page_height
page_height = asked_height > 0 ? asked_height : page_height + legend_height
# Fonts are said in pt of 3/4 of a px, lines of PDF in half pt.
if (drawing eq 'svg') {
    set terminal svg size page_width,page_height font font_name.',12' fontscale 1.3333 background '#ffffff' noenhanced
}
if (drawing eq 'png') {
    set terminal pngcairo size int(px_dots*page_width),int(px_dots*page_height) font font_name.',12' fontscale px_dots \
        linewidth px_dots pointscale px_dots background '#ffffff' noenhanced
}
if (drawing eq 'pdf') {
    set terminal pdfcairo size page_width*px_points/72,page_height*px_points/72 font font_name.',12' fontscale px_points \
        linewidth 2*px_points pointscale px_points background '#ffffff' noenhanced
}
if (drawing eq 'gif') {
    set terminal gif animate delay delay optimize size page_width,page_height font font_name.',12' \
        fontscale 1 background '#ffffff' noenhanced
}
set output 'picture.'.drawing
if (drawing ne 'gif') { set multiplot } # each plot is a frame of its own
set datafile missing 'NaN'
unset key
set label title_text(title, title_size) at screen X(margin), Y(margin + 0.6*title_size) left font ',15' front
set label title_text(subtitle, text_size) at screen X(margin), \
    Y(margin + lines_height(title_text(title, title_size), title_size) + 2 + 0.6*text_size) \
    left font ',12' textcolor '#505050' front

do for [p=1:panels] {
    f_middle = panel_top[p] + 0.5*panel_high[p]
    if (heading(p) ne '') { set label heading(p) at screen X(panel_left(p)), Y(panel_top[p] - 10) left font columns > 1 ? ',10' : ',11' front }
    if (panel_right[p] ne '') { set label panel_right[p] at screen X(panel_left(p) + width), Y(panel_top[p] - 10) right @tiny front }
    if (panel_y[p] eq '' && chart_beside ne '') { set label chart_beside at screen X(left - 10), Y(f_middle) right font ',12' front }
    if (panel_y[p] ne '' && panel_y[p] ne 'y') {
        eval y_label(axis_label(panel_y[p], panel_high[p] + 14), panel_left(p) - (columns > 1 && p > leads ? 58 + 24*wide_tics : left - 22), f_middle)
    }
    if (panel_x[p] ne 'x') {
        f_label = p <= leads || columns == 1 ? axis_label(panel_x[p], panel_wide(p) + 28) : end_of(value(panel_x[p]."_path"), (width + at_most(28, across - 8))/6.9)
        set label f_label at screen X(panel_left(p) + 0.5*panel_wide(p)), Y(panel_top[p] + panel_high[p] + (p <= leads ? 46 : 42)) center @small front
    }
}
# Long names may go on beside the labels under the panels, but not into the title.
grid_top = row_top[leads + 1]
if (shared_y ne '') { eval y_label(axis_label('y', bottom - grid_top + 28), 22, 0.5*(grid_top + bottom) + 8) }
if (!own_x) { eval x_label(0.5*(left + right), bottom + (foot < 84 ? 42 : 46)) }
fits_aside = (sum [p=1:panels] (7*strlen(panel_aside[p]) > panel_high[p] + head)) == 0
do for [p=1:(asides ? panels : 0)] {
    set label fits_aside ? panel_aside[p] : panel_aside_bare[p] at screen X(right + 14), Y(panel_top[p] + 0.5*panel_high[p]) \
        center rotate by -90 @tiny front
}
if (form > 1 && column_name ne '') { set label column_name at screen X(0.5*(left + right)), Y(row_top[1] - 28) center @tiny front }
if (!fits_aside) { set label row_name at screen X(right + 32), Y(0.5*(row_top[1] + bottom)) center rotate by -90 @tiny front }
# Stretches of the axis x of all panels, named above them, with lines between.
place_x(x) = left + width*(x - x_low)/(x_high - x_low)
do for [k=1:stretches] {
    if (place_x(stretch_to[k]) - place_x(stretch_from[k]) > 7*strlen(stretch_text[k])) {
        set label stretch_text[k] at screen X(place_x(0.5*(stretch_from[k] + stretch_to[k]))), Y(row_top[1] - 11) center @small front
    }
    if (k < stretches) {
        set arrow from screen X(place_x(stretch_to[k])),Y(row_top[1]) to screen X(place_x(stretch_to[k])),Y(bottom) nohead lc rgb '#b8b8b8' lw 1 back
    }
}
# Names at the right ends of the lines of a panel, the lowest first, apart from each other: up from the lowest, then
# down from the highest.
if (ends > 0) {
    array end_y[ends]
    f_high = panel_high[end_panel]; f_top = panel_top[end_panel]
    f_low = value(panel_y[end_panel].'_low'); f_most = value(panel_y[end_panel].'_high')
    line_end(k) = f_top + f_high*(f_most - end_at[k])/(f_most - f_low)
    f_step = at_most(14, f_high/ends)
    do for [k=1:ends] { end_y[k] = k > 1 ? at_most(line_end(k), end_y[k-1] - f_step) : line_end(k) }
    end_y[ends] = at_least(end_y[ends], f_top)
    do for [i=1:ends-1] { k = ends - i; end_y[k] = at_least(end_y[k], end_y[k+1] + f_step) }
    do for [k=1:ends] {
        set label end_text[k] at screen X(right + 22), Y(end_y[k]) left @tiny front
        set arrow from screen X(right + 2),Y(line_end(k)) to screen X(right + 19),Y(end_y[k]) nohead lc rgb end_colour[k] lw 1 front
    }
}
legend_x = (leads ? left + lead_width : right + row_head) + 20
legend_y = row_top[1] + 10

# ---- title, labels and objects given so far, with the legend at legend_x, legend_y (its first line) or below the panels;
# panels follow, over it ----
if (legend_below) { legend_x = margin; legend_y = legend_floor + 6 + table_top }
if (legend_head ne '') { set label legend_head at screen X(legend_x), Y(legend_y) left @small front }
do for [k=1:legends] {
    eval mark(k, legend_x + entry_x[k], legend_y + entry_y[k])
    set label legend_text[k] at screen X(legend_x + entry_x[k] + legend_indent), Y(legend_y + entry_y[k]) left font ',12' front
    if (legend_about[k] ne '') { set label legend_about[k] at screen X(legend_x + entry_x[k] + legend_indent), Y(legend_y + entry_y[k] + 3) left font ',9' front }
}
# Entries of the legend as rows of a table.
f_wide = table_columns > 0 ? (page_width - 2*margin - table_names)/table_columns : 0
do for [c=1:table_columns] {
    f_left = margin + table_names + (c - 1)*f_wide
    set label wrap(table_head[c], f_wide/8) at screen X(f_left), Y(legend_y - 22 - 8*(lines(wrap(table_head[c], f_wide/8)) - 1)) left @small front
    do for [k=1:legends] {
        f_cell = (k - 1)*table_columns + c
        set label cell_text[f_cell] at screen X(f_left), Y(legend_y + entry_y[k]) left @small front
        set label cell_more[f_cell] at screen X(f_left), Y(legend_y + entry_y[k] + 15) left @small front
    }
}
line = legend_y + notes_y + 2
do for [k=1:notes] {
    set label note[k] at screen X(legend_x), Y(line) left @small front
    line = line + 17*lines(note[k])
}
eval panel(0, 0, page_width, page_height)
unset border; unset tics
# Nothing of the plot is seen but what was set before; frames of a picture that moves have that each.
if (frames < 2) {
    plot [0:1][0:1] 2 notitle
    unset label; unset object; unset arrow
}
set border 31 lw 0.8 lc '#404040'
set xtics nomirror out scale 0.6 textcolor '#202020'
set ytics nomirror out scale 0.6 textcolor '#202020'

if (bars) {
    if (!(bar_high > bar_low)) { bar_low = bar_low - 0.5; bar_high = bar_low + 1 } # a range of nothing cannot be drawn
    eval palette
    set cbrange [bar_low:bar_high]
    set cbtics round_step(bar_low, bar_high, 6) nomirror out scale 0
    set format cb bar_format
    set cblabel bar_text offset 0.5,0
    eval legend_bar(0)
}
if (ground >= 0) { set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor rgb ground fillstyle solid noborder }
# Of a picture that moves what stands still is drawn before the frames where these are laid over it (SVG).
still = frames > 1 && drawing eq 'svg'
do for [f=1-still:frames] {
    if (frames > 1) { # the view moves, and the time
        f_at = at_least(f, 1)
        x_low = low_x + centre[f_at]; x_high = high_x + centre[f_at]
        y1_low = low_y + base[f_at]; y1_high = high_y + base[f_at]
        f_time = f > 0 ? sprintf('%.2f s', (f - 1)*frame_step) : ''
        set label 1000 f_time at screen X(right),Y(row_top[1] - 10) right font ',12' front
    }
    do for [p=1:panels] {
        eval panel(panel_left(p), panel_top[p], panel_wide(p), panel_high[p])
        eval gridded && p > leads ? grid : 'unset grid'
        eval axis_tics(panel_x[p], panel_wide(p)/(panel_wide(p) < 300 ? 50 : 64), panel_x[p] ne 'x' || p + columns > panels)
        f_font = panel_wordy[p] ? ',8' : ',12' # words are long, panels are not
        set xtics font f_font
        if (panel_y[p] eq '') {
            unset grid
            set yrange [0:1]
            set ytics (-1) # none in sight
        } else {
            f_tics = value(panel_y[p].'_scale') eq 'list' ? 99 : panel_high[p] < 160 ? 4 : int(panel_high[p]/(panel_high[p] > 400 ? 46 : 36))
            eval axis_tics(panel_y[p], f_tics, panel_y[p] ne 'y' || column_of(p) == 0)
        }
        if (plain || still && (f > 0 || travels)) { unset border; unset xtics; unset ytics; unset grid }
        eval 'plot '.(f > 0 ? panel_plot[p][3:*] : 'NaN notitle')
        unset colorbox # one for all
    }
    if (f == 0) { unset label; unset object; unset arrow }
}
