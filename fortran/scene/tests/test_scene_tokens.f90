!> The text of a scene file falls into the right tokens on the right lines.
program test_scene_tokens
   use base_kinds, only: ik
   use scene_expression, only: token_comma, token_end, token_equals, token_group, token_list_t, &
                               token_slash, token_text, token_word, tokenize, unquoted
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=1), parameter :: line_feed = achar(10), carriage_return = achar(13)
   type(checks_t) :: checks
   type(token_list_t) :: tokens
   character(len=:), allocatable :: source, fault
   integer(ik) :: fault_line

   source = "! &no = 1 /"//carriage_return//line_feed//"&Group x=3*1.0,"//line_feed//achar(9)// &
            "n = 'it''s ! / &' /"
   call tokenize(source, tokens, fault, fault_line)
   call checks%is_true(.not. allocated(fault), "a good text")
   call checks%is_true(tokens%length == 10, "number of tokens")
   call checks%is_true(all(tokens%items(1:10)%kind == &
                           [token_group, token_word, token_equals, token_word, token_comma, &
                            token_word, token_equals, token_text, token_slash, token_end]), "kinds")
   call checks%is_true(all(tokens%items(1:9)%line == [2, 2, 2, 2, 2, 3, 3, 3, 3]), "lines")
   call checks%is_true(piece(1) == "Group" .and. piece(4) == "3*1.0", "words")
   call checks%is_true(unquoted(piece(8)) == "it's ! / &", "a doubled quote is one")
   call checks%is_true(unquoted('"a""b''"') == 'a"b''', "double quotes")
   call checks%is_true(unquoted("''") == "", "an empty text")

   call tokenize(char(239)//char(187)//char(191)//"&g /", tokens, fault, fault_line)
   call checks%is_true(tokens%length == 3 .and. .not. allocated(fault), "byte-order mark")
   call tokenize("", tokens, fault, fault_line)
   call checks%is_true(tokens%length == 1, "an empty text is the end alone")
   call tokenize("&g"//line_feed//"t = 'open"//line_feed//"'", tokens, fault, fault_line)
   call checks%is_true(allocated(fault) .and. fault_line == 2, "a text must close on its line")
   call tokenize("&g t = 'open''", tokens, fault, fault_line)
   call checks%is_true(allocated(fault), "a doubled quote does not close")
   call tokenize("&g"//line_feed//line_feed//achar(0), tokens, fault, fault_line)
   call checks%is_true(allocated(fault) .and. fault_line == 3, "a zero byte")
   call checks%finish()

contains

   function piece(i) result(word)
      integer, intent(in) :: i
      character(len=:), allocatable :: word

      word = source(tokens%items(i)%first:tokens%items(i)%last)
   end function piece

end program test_scene_tokens
