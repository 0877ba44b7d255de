# page.gp - begins a page of page_width x page_height px with title and subtitle, and with the legend below them where
# it stands there; labels and objects of the whole page may follow, then panels.gp. A px is px_points pt of a page of
# an asked size and of PDF, px_dots dots of a PNG.
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
