# plot_speed.gp - bars of the charts `rivals` and `methods`, and the wall time of a whole map over its cases.
left = 100
row_height = 20 # of legends
tics_height = 64
page_width = asked_width > 0 ? at_least(900, asked_width) : 1240
map_width = 0.25*page_width
map_left = page_width - map_width - 30
rivals_width = map_ranks > 0 ? map_left - left - 110 : page_width - left - 30
# Legends: entries one after the other, in rows.
array rivals_x[16]; array rivals_y[16]; array methods_x[16]; array methods_y[16]
rows_of(which, room) = (f_x = 0, f_y = 0, sum [f_s=1:value(which.'_series')] (f_w = 38 + 8.7*entry_length(which, f_s), \
    f_y = f_x > 0 && f_x + f_w > room ? f_y + 1 : f_y, f_x = f_x > 0 && f_x + f_w > room ? 0 : f_x, \
    put(which, f_s, f_x, f_y), f_x = f_x + f_w, 0), f_y + 1)
entry_length(which, s) = which eq 'rivals' ? strlen(rivals_name[s]) : methods_drawn[s] ? strlen(methods_name[s]) : -4
put(which, s, x, y) = which eq 'rivals' ? (rivals_x[s] = x, rivals_y[s] = y) : (methods_x[s] = x, methods_y[s] = y)
rivals_rows = rows_of('rivals', rivals_width)
methods_rows = rows_of('methods', page_width - left - 30)
array map_text[2] = ['every case', 'refined']

top = title_height(0) + (rivals_rows + 1)*row_height + 8
others = top + 2*tics_height + (methods_rows + 1)*row_height + 8
upper = asked_height > 0 ? at_least(100, 0.53*(asked_height - others)) : 330
lower = asked_height > 0 ? at_least(100, 0.47*(asked_height - others)) : 290
second = top + upper + tics_height + (methods_rows + 1)*row_height + 8
page_height = second + lower + tics_height
load 'page.gp'

head(text, left, bottom) = sprintf("set label '%s' at screen X(%d), Y(%g) left font ',12' front", text, left, bottom - 2)
eval head(rivals_scene.(rivals_width < 600 ? '' : ', implicit: one lane and more').', beside the step written by hand and MuJoCo', \
    left, top - (rivals_rows + 1)*row_height)
eval head('Every method in every scene, in the widest instruction set', left, second - (methods_rows + 1)*row_height)
entry(x, y, name, colour) = box(x, y, colour).sprintf("; set label %s at screen X(%.6f), Y(%.6f) left font ',12' front", name, x + 22, y)
do for [s=1:rivals_series] {
    eval entry(left + rivals_x[s], top - (rivals_rows - rivals_y[s])*row_height + 4, sprintf('rivals_name[%d]', s), shade(rivals_colour[s]))
}
do for [s=1:methods_series] {
    if (methods_drawn[s]) {
        eval entry(left + methods_x[s], second - (methods_rows - methods_y[s])*row_height + 4, sprintf('methods_name[%d]', s), \
            shade(methods_colour[s]))
    }
}
if (map_ranks > 0) {
    eval head('The shipped map, basin_one_foot', map_left, top - 2*row_height)
    do for [m=1:2] {
        if (map_drawn[m]) { eval entry(map_left + (map_width < 250 ? 100 : 120)*(m - 1), top - row_height + 4, sprintf('map_text[%d]', m), hue[m]) }
    }
    set label efficiency at screen X(map_left + map_width - 8), Y(top + upper - 16) right font ',9' front
}
load 'panels.gp'

# Two or three digits.
digits(v) = v < 9.95 ? sprintf('%.1f', v) : v < 9995 ? sprintf('%.0f', v) : sprintf('%.0fk', v/1000)
set xtics @tiny
set ytics @tiny
set ylabel 'nanoseconds per case-step of one core' @tiny
if (rivals_series > 0) {
    eval panel(left, top, rivals_width, upper)
    set logscale y
    set grid y lc '#e4e4e4' lw 0.6
    eval log_tics('y', log10(0.5*rivals_low), log10(2.2*rivals_high), 10, 1, 1)
    set xrange [-0.5:rivals_groups - 0.5]
    set xtics scale 0 ('' 0)
    do for [i=1:rivals_groups] { set xtics add (rivals_group[i] i - 1) }
    bar = 0.86/rivals_series
    rivals(s) = '$rivals'.s
    place(s) = bar*(s - 0.5*(rivals_series + 1))
    plot NaN notitle, for [s=1:rivals_series] rivals(s) using ($1 + place(s)):2:(0.9*bar) \
            with boxes fs solid 0.9 border lc rgb shade(rivals_colour[s]) lc rgb shade(rivals_colour[s]) lw 0.5 notitle, \
        for [s=1:rivals_series] rivals(s) using ($1 + place(s)):3:(0):($4 - $3) with vectors nohead lc rgb '#303030' lw 1.2 notitle, \
        for [s=1:rivals_series] rivals(s) using ($1 + place(s)):($4*1.06):(digits($2)) with labels font (0.86*rivals_width/rivals_groups/rivals_series < 26 ? ',6' : ',8') center offset 0,0.5 notitle
}
if (methods_groups > 0) {
    eval panel(left, second, page_width - left - 30, lower)
    set logscale y
    set grid y lc '#e4e4e4' lw 0.6
    eval log_tics('y', log10(0.5*methods_low), log10(2.2*methods_high), 10, 1, 1)
    set xrange [-0.5:methods_groups - 0.5]
    set xtics scale 0 ('' 0)
    do for [i=1:methods_groups] { set xtics add (methods_group[i]."\n".methods_within[i] i - 1) }
    bar = 0.86/methods_series
    methods(s) = '$methods'.s
    place(s) = bar*(s - 0.5*(methods_series + 1))
    plot NaN notitle, for [s=1:methods_series] methods(s) using ($1 + place(s)):2:(0.9*bar) \
            with boxes fs solid 0.9 border lc rgb shade(methods_colour[s]) lc rgb shade(methods_colour[s]) lw 0.5 notitle, \
        for [s=1:methods_series] methods(s) using ($1 + place(s)):3:(0):($4 - $3) with vectors nohead lc rgb '#303030' lw 1.2 notitle
}
if (map_ranks > 0) {
    eval panel(map_left, top, map_width, upper)
    set logscale xy
    set xlabel 'cases of the stability map' @tiny
    set ylabel sprintf('wall time of the program on %d rank%s (s)', map_ranks, map_ranks == 1 ? '' : 's') @tiny
    eval grid
    eval log_tics('y', log10(0.4*shortest), log10(2.5*longest), 10, 1, 1)
    set xrange [0.5*fewest:2*most]
    set xtics scale 0.6 ('' fewest)
    side(cases) = sprintf('%.0f²', sqrt(cases))
    drawn = map_drawn[1] && map_drawn[2] ? '1 2' : map_drawn[1] ? '1' : '2'
    plot NaN notitle, for [m in drawn] '$map'.m using 1:2:xtic(side($1)) with lines lc rgb hue[m+0] lw 1.6 notitle, \
        for [m in drawn] '$map'.m using 1:2:3:4 with yerrorbars lc rgb hue[m+0] pt 7 ps 0.8 lw 1 notitle, \
        for [m in drawn] '$map'.m using 1:2:(digits($2)) with labels font ',9' right offset -0.8,0.7 notitle
}
