# plot_animation.gp - frames of stick figures, `step` seconds apart; a second case is grey. Both directions have the
# same scale.
left = 70
page_width = asked_width > 0 ? at_least(300, asked_width) : 720
top = title_height(0) + 34
width = page_width - left - margin
scale = at_most(width/(high_x - low_x), 480.0/(high_z - low_z))
height = scale*(high_z - low_z)
page_height = int(top + height + 60)
delay = int(100*step + 0.5)
load 'page.gp'

group_colour(k) = k < contacts ? hue[k%|hue|+1] : 0x303030
place = left
do for [k=0:contacts] {
    name = k < contacts ? contact_name[k+1] : 'body'
    eval box(place, top - 16, group_colour(k))
    set label name at screen X(place + 22), Y(top - 16) left font ',12'
    place = place + 50 + 8.2*strlen(name)
}
if (cases > 1) {
    eval box(place, top - 16, 0xb8b8b8)
    set label 'the second case' at screen X(place + 22), Y(top - 16) left font ',12'
}
set label 'm' at screen X(left + width), Y(top + height + 44) right @small
eval panel(left + 0.5*(width - scale*(high_x - low_x)), top, scale*(high_x - low_x), height)
set label 1000 '' at screen X(left + width), Y(top - 16) right font ',12' front # not that of another text
axes = sprintf("set border 3 front lw 0.8 lc '#404040'; set tics front; set xtics %g nomirror out scale 0.6; " \
    ."set ytics %g nomirror out scale 0.6", round_step(0, high_x - low_x, 6), round_step(0, high_z - low_z, 5))
no_axes = 'unset border; unset xtics; unset ytics'
# In SVG what follows the first curve of a plot, all that is in front, is a frame; what stands still, a plot before.
if (drawing eq 'svg') {
    set xrange [low_x:high_x]
    set yrange [low_z:high_z]
    eval (follows ? no_axes : axes)
    plot NaN notitle
}
eval (drawing eq 'svg' && !follows ? no_axes : axes)
set samples 2 # of even ground, a straight line
do for [f=1:frames] {
    set xrange [centre[f] + low_x:centre[f] + high_x]
    set yrange [base[f] + low_z:base[f] + high_z]
    set label 1000 sprintf('%.2f s', (f - 1)*step)
    plot for [k=uneven:0] -fall*x with lines lw 2 lc rgb '#a0a0a0' notitle, \
        for [k=1:uneven] '$ground' index f-1 using 1:2 with lines lw 2 lc rgb '#a0a0a0' notitle, \
        for [c=cases:2:-1] '$segments'.c index f-1 using 1:2 with lines lw 3 lc rgb '#b8b8b8' notitle, \
        for [k=contacts:0:-1] $segments1 index f-1 using 1:($3 == k ? $2 : NaN) with lines lw 3 lc rgb group_colour(k) notitle, \
        for [k=contacts:0:-1] $points1 index f-1 using 1:($3 == k ? $2 : NaN) with points pt 7 ps 0.9 lc rgb group_colour(k) notitle
}
