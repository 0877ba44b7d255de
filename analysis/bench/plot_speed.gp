# plot_speed.gp - bars of the charts `rivals` and `methods`, and the wall time of a whole map over its cases.
left = 100
upper = 330
lower = 290
rivals_width = 690
map_left = 900
map_width = 310
row_height = 20 # of legends
tics_height = 64
array map_text[2] = ['every case', 'refined']

page_width = 1240
top = title_height(0) + 2*row_height + 8
second = top + upper + tics_height + 2*row_height + 8
page_height = second + lower + tics_height
load 'page.gp'

head(text, left, top) = sprintf("set label '%s' at screen X(%d), Y(%g) left font ',12' front", text, left, top - 2*row_height - 2)
eval head(rivals_scene.', implicit: one lane and more, beside the step written by hand and MuJoCo', left, top)
eval head('Every method in every scene, in the widest instruction set', left, second)
# A legend of entries one after the other.
entry(x, y, name, colour) = box(x, y, colour).sprintf("; set label %s at screen X(%.6f), Y(%.6f) left font ',12' front", name, x + 22, y)
x_entry = left
do for [s=1:rivals_series] {
    eval entry(x_entry, top - row_height + 4, sprintf('rivals_name[%d]', s), rivals_colour[s])
    x_entry = x_entry + 38 + 8.7*strlen(rivals_name[s])
}
x_entry = left
do for [s=1:methods_series] {
    if (methods_drawn[s]) {
        eval entry(x_entry, second - row_height + 4, sprintf('methods_name[%d]', s), methods_colour[s])
        x_entry = x_entry + 38 + 8.7*strlen(methods_name[s])
    }
}
if (map_ranks > 0) {
    eval head('The shipped map, basin_one_foot', map_left, top)
    do for [m=1:2] {
        if (map_drawn[m]) { eval entry(map_left + 120*(m - 1), top - row_height + 4, sprintf('map_text[%d]', m), hue[m]) }
    }
    set label efficiency at screen X(map_left + map_width - 8), Y(top + upper - 16) right font ',9' front
}
legend_x = 0
legend_y = 0
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
            with boxes fs solid 0.9 border lc rgb rivals_colour[s] lc rgb rivals_colour[s] lw 0.5 notitle, \
        for [s=1:rivals_series] rivals(s) using ($1 + place(s)):3:(0):($4 - $3) with vectors nohead lc rgb '#303030' lw 1.2 notitle, \
        for [s=1:rivals_series] rivals(s) using ($1 + place(s)):($4*1.06):(digits($2)) with labels font ',8' center offset 0,0.5 notitle
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
            with boxes fs solid 0.9 border lc rgb methods_colour[s] lc rgb methods_colour[s] lw 0.5 notitle, \
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
    plot NaN notitle, for [m=1:2] '$map'.m using 1:2:xtic(side($1)) with lines lc rgb hue[m] lw 1.6 notitle, \
        for [m=1:2] '$map'.m using 1:2:3:4 with yerrorbars lc rgb hue[m] pt 7 ps 0.8 lw 1 notitle, \
        for [m=1:2] '$map'.m using 1:2:(digits($2)) with labels font ',9' right offset -0.8,0.7 notitle
}
